include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
# The components are packages: the library, what one builds against it with, the program, the Python module.
install(TARGETS diminish EXPORT diminish-targets
  LIBRARY COMPONENT library NAMELINK_COMPONENT development)
install(TARGETS diminish_program COMPONENT program)
if(NOT CMAKE_CROSSCOMPILING AND NOT DIMINISH_SANITIZE)
  set(DIMINISH_ZSH_COMPLETIONS ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING
    "Where zsh looks for completion")
  install(DIRECTORY ${PROJECT_BINARY_DIR}/help/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/help/completion/diminish
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/help/completion/_diminish
    DESTINATION ${DIMINISH_ZSH_COMPLETIONS} COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/help/completion/diminish.fish
    DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
endif()
install(TARGETS diminish_membrane EXPORT diminish-membrane-targets ARCHIVE COMPONENT development)
install(DIRECTORY include/diminish TYPE INCLUDE COMPONENT development)
install(FILES include/diminish_c.h TYPE INCLUDE COMPONENT development)
set(cmake_files ${CMAKE_INSTALL_LIBDIR}/cmake/diminish)
install(EXPORT diminish-targets NAMESPACE diminish:: DESTINATION ${cmake_files} COMPONENT development)
install(EXPORT diminish-membrane-targets NAMESPACE diminish:: DESTINATION ${cmake_files} COMPONENT development)
configure_package_config_file(cmake/diminish-config.cmake.in diminish-config.cmake
  INSTALL_DESTINATION ${cmake_files})
write_basic_package_version_file(diminish-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/diminish-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/diminish-config-version.cmake
  DESTINATION ${cmake_files} COMPONENT development)

file(RELATIVE_PATH prefix_from_pc /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/diminish.pc.in diminish.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/diminish.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT development)
if(DIMINISH_DEBIAN)
  include(cmake/debian.cmake)
endif()
if(DIMINISH_BUILD_TESTS)
  add_test(NAME library_as_installed COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-library ${PROJECT_BINARY_DIR})
  set_tests_properties(library_as_installed PROPERTIES TIMEOUT 600)
  find_program(ABIDW_PROGRAM abidw)
  if(ABIDW_PROGRAM AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    add_test(NAME abi COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-abi $<TARGET_FILE:diminish>)
  endif()
  # What is delivered: hardened, listed, signed.
  if(DIMINISH_HARDENING AND NOT DIMINISH_SANITIZE AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
    add_test(NAME hardening COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-hardening
      $<TARGET_FILE:diminish> $<TARGET_FILE:diminish_program>)
  endif()
  find_program(DPKG_QUERY_PROGRAM dpkg-query)
  find_program(GPG_PROGRAM gpg)
  if(DPKG_QUERY_PROGRAM AND CMAKE_GENERATOR STREQUAL "Ninja")
    add_test(NAME sbom COMMAND ${PROJECT_SOURCE_DIR}/scripts/sbom --check ${PROJECT_BINARY_DIR})
    if(GPG_PROGRAM)
      add_test(NAME release COMMAND ${PROJECT_SOURCE_DIR}/scripts/test-release ${PROJECT_BINARY_DIR})
    endif()
  endif()
endif()
