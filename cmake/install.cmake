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

file(RELATIVE_PATH prefix_from_pc /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/diminish.pc.in diminish.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/diminish.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
if(DIMINISH_BUILD_TESTS)
  add_test(NAME library_as_installed COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-library ${PROJECT_BINARY_DIR})
  set_tests_properties(library_as_installed PROPERTIES TIMEOUT 600)
endif()
