# OpenImageIO::OpenImageIO from header and library alone. Debian's own config file also wants the command-line tools,
# OpenCV's headers and Imath's Python binding, none of which Pelage uses; this asks for what is linked.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h)
find_library(OpenImageIO_LIBRARY OpenImageIO)
find_library(OpenImageIO_Util_LIBRARY OpenImageIO_Util)
find_path(OpenImageIO_Imath_INCLUDE_DIR Imath/ImathVec.h)
mark_as_advanced(OpenImageIO_INCLUDE_DIR OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY OpenImageIO_Imath_INCLUDE_DIR)

if(OpenImageIO_INCLUDE_DIR AND EXISTS ${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h)
  file(STRINGS ${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h _lines REGEX "define OIIO_VERSION_(MAJOR|MINOR|PATCH) ")
  string(REGEX REPLACE "[^0-9]+" "." OpenImageIO_VERSION "${_lines}")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" OpenImageIO_VERSION "${OpenImageIO_VERSION}")
  unset(_lines)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO
  REQUIRED_VARS OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY OpenImageIO_INCLUDE_DIR OpenImageIO_Imath_INCLUDE_DIR
  VERSION_VAR OpenImageIO_VERSION)

if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
  add_library(OpenImageIO::OpenImageIO UNKNOWN IMPORTED)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    IMPORTED_LOCATION ${OpenImageIO_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR};${OpenImageIO_Imath_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES ${OpenImageIO_Util_LIBRARY})
endif()
