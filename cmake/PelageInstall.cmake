# `cmake --install`: the library, its headers, the command, the licence, and a package that find_package(Pelage) finds.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(PELAGE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Pelage)

install(TARGETS pelage EXPORT PelageTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
                                            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/pelage DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
if(TARGET pelage_cli)
  install(TARGETS pelage_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(FILES LICENSE THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(EXPORT PelageTargets NAMESPACE Pelage:: DESTINATION ${PELAGE_PACKAGE_DIR})
configure_package_config_file(cmake/PelageConfig.cmake.in PelageConfig.cmake INSTALL_DESTINATION ${PELAGE_PACKAGE_DIR})
write_basic_package_version_file(PelageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/PelageConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/PelageConfigVersion.cmake
              cmake/FindOpenEXR.cmake DESTINATION ${PELAGE_PACKAGE_DIR})
