# OpenEXR::OpenEXR from headers and libraries alone. Debian's own config file also wants Imath's Python binding, which Pelage
# does not use; this asks for what is linked.
find_path(OpenEXR_INCLUDE_DIR OpenEXR/ImfInputFile.h)
find_path(OpenEXR_Imath_INCLUDE_DIR Imath/ImathBox.h)
find_library(OpenEXR_LIBRARY OpenEXR)
find_library(OpenEXR_Iex_LIBRARY Iex)
find_library(OpenEXR_Imath_LIBRARY Imath)
mark_as_advanced(OpenEXR_INCLUDE_DIR OpenEXR_Imath_INCLUDE_DIR OpenEXR_LIBRARY OpenEXR_Iex_LIBRARY OpenEXR_Imath_LIBRARY)

if(OpenEXR_INCLUDE_DIR AND EXISTS ${OpenEXR_INCLUDE_DIR}/OpenEXR/OpenEXRConfig.h)
  file(STRINGS ${OpenEXR_INCLUDE_DIR}/OpenEXR/OpenEXRConfig.h _line REGEX "define OPENEXR_VERSION_STRING ")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" OpenEXR_VERSION "${_line}")
  unset(_line)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenEXR
  REQUIRED_VARS OpenEXR_LIBRARY OpenEXR_Iex_LIBRARY OpenEXR_Imath_LIBRARY OpenEXR_INCLUDE_DIR OpenEXR_Imath_INCLUDE_DIR
  VERSION_VAR OpenEXR_VERSION)

if(OpenEXR_FOUND AND NOT TARGET OpenEXR::OpenEXR)
  add_library(OpenEXR::OpenEXR UNKNOWN IMPORTED)
  set_target_properties(OpenEXR::OpenEXR PROPERTIES
    IMPORTED_LOCATION ${OpenEXR_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${OpenEXR_INCLUDE_DIR}/OpenEXR;${OpenEXR_Imath_INCLUDE_DIR}/Imath"
    INTERFACE_LINK_LIBRARIES "${OpenEXR_Iex_LIBRARY};${OpenEXR_Imath_LIBRARY}")
endif()
