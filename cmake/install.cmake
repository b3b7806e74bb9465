include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
install(TARGETS diminish EXPORT diminish-targets)
install(TARGETS diminish_program)
install(TARGETS diminish_membrane EXPORT diminish-membrane-targets)
install(DIRECTORY include/diminish TYPE INCLUDE)
install(EXPORT diminish-targets NAMESPACE diminish:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/diminish)
install(EXPORT diminish-membrane-targets NAMESPACE diminish::
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/diminish)
configure_package_config_file(cmake/diminish-config.cmake.in diminish-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/diminish)
write_basic_package_version_file(diminish-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/diminish-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/diminish-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/diminish)
