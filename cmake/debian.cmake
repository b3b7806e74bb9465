# Debian's packages, by CPack: libdiminish0, libdiminish-dev, diminish, python3-diminish,
# gstreamer1.0-diminish (make deb).
find_program(DPKG_PROGRAM dpkg REQUIRED)
set(packages libdiminish0 libdiminish-dev diminish python3-diminish)
set(components library development program python)
if(TARGET diminish_gstreamer)
  list(APPEND packages gstreamer1.0-diminish)
  list(APPEND components gstreamer)
endif()
# As Debian's own tools: who packs it; without these variables, the last commit's author.
set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
if("$ENV{DEBEMAIL}" STREQUAL "")
  find_package(Git REQUIRED)
  execute_process(COMMAND ${GIT_EXECUTABLE} log -1 "--format=%an <%ae>" WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE maintainer OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME diminish)
set(CPACK_PACKAGE_CONTACT ${maintainer})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(exactly "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

set(what "diminish removes real objects from a camera's picture and shows what is
behind them. One colour camera is the user's eye; RGB-D cameras elsewhere
see what the object hides.")
function(debian_package component name section depends about)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS ${depends} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${what}\n.\nThis package has the ${about}." PARENT_SCOPE)
endfunction()
debian_package(library libdiminish0 libs "" "shared library")
debian_package(development libdiminish-dev libdevel
  "libdiminish0 ${exactly}, libeigen3-dev, libtbb-dev, libhwy-dev" "headers and development files")
debian_package(program diminish graphics "" "command-line program")
set(before_and_after "")
if(DIMINISH_PYTHON_VERSION MATCHES "^([0-9]+)\\.([0-9]+)$")
  math(EXPR next "${CMAKE_MATCH_2} + 1")
  set(before_and_after ", python3 (>= ${DIMINISH_PYTHON_VERSION}~), python3 (<< ${CMAKE_MATCH_1}.${next})")
endif()
debian_package(python python3-diminish python
  "libdiminish0 ${exactly}, python3-numpy${before_and_after}" "Python module")
debian_package(gstreamer gstreamer1.0-diminish libs "libdiminish0 ${exactly}" "GStreamer element")

file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)

# What the policy wants in /usr/share/doc.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is set
find_program(GZIP_PROGRAM gzip REQUIRED)
configure_file(cmake/debian_copyright.in debian/copyright @ONLY)
foreach(package component IN ZIP_LISTS packages components)
  set(folder ${PROJECT_BINARY_DIR}/debian/${package})
  file(WRITE ${folder}/changelog.Debian "diminish (${PROJECT_VERSION}-1) unstable; urgency=medium\n
  * See /usr/share/doc/${package}/changelog.gz.\n
 -- ${maintainer}  ${date}\n")
  file(COPY_FILE ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${folder}/changelog)
  execute_process(COMMAND ${GZIP_PROGRAM} -9nf changelog changelog.Debian WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${folder}/changelog.gz ${folder}/changelog.Debian.gz ${PROJECT_BINARY_DIR}/debian/copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()
# man's pages are compressed there.
install(CODE "execute_process(COMMAND sh -c \"find . -name '*.1' -exec ${GZIP_PROGRAM} -9nf {} +\"
  WORKING_DIRECTORY \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")" COMPONENT program)
include(CPack)
