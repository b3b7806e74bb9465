# What every target of this project, and nothing that uses it, is compiled with.
add_library(diminish_build_options INTERFACE)
target_compile_options(diminish_build_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough -Wno-missing-field-initializers
  # The same bytes on every machine: no contraction of a*b+c where the source does not say so.
  -ffp-contract=off
  # Nobody reads errno or floating-point exceptions: rounding is an instruction, comparisons are
  # vectorised. No result depends on it.
  -fno-math-errno -fno-trapping-math)
# The library's functions call each other, not what another library may call by the same name.
target_compile_options(diminish_build_options INTERFACE -fno-semantic-interposition)
target_link_options(diminish_build_options INTERFACE -Wl,-Bsymbolic-functions)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 sees overlaps in std::string's operator+ that are not there (GCC bug 105651).
  target_compile_options(diminish_build_options INTERFACE -Wno-restrict)
  if(DIMINISH_PRECOMPILE_HEADERS OR DIMINISH_UNITY_BUILD)
    # Nor does it tell any more that what it warns of is the standard library's own.
    target_compile_options(diminish_build_options INTERFACE -Wno-stringop-overflow -Wno-stringop-overread
      -Wno-array-bounds)
    # Collecting its garbage before half a gigabyte is in use takes a few per cent of its time.
    target_compile_options(diminish_build_options INTERFACE --param=ggc-min-heapsize=500000)
  endif()
endif()
if(DIMINISH_UNITY_BUILD)
  # What stands in another file's unnamed namespace may well be hidden by a local name.
  target_compile_options(diminish_build_options INTERFACE
    -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local> $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(DIMINISH_WARNINGS_AS_ERRORS)
  target_compile_options(diminish_build_options INTERFACE -Werror)
endif()
if(NOT DIMINISH_SANITIZE)
  # No path of the machine that it was built on: the same source gives the same bytes (scripts/reproduce).
  target_compile_options(diminish_build_options INTERFACE -ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)
endif()
if(DIMINISH_HARDENING AND NOT DIMINISH_SANITIZE)
  # What a camera, a file or a network sends must not become code. As Debian builds its packages.
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES C CXX)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  target_compile_options(diminish_build_options INTERFACE
    -fstack-protector-strong $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE>  # some compilers bring their own
    $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    target_compile_options(diminish_build_options INTERFACE -fcf-protection)
  endif()
  target_link_options(diminish_build_options INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
if(DIMINISH_SANITIZE)
  add_compile_options(-fsanitize=${DIMINISH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${DIMINISH_SANITIZE})
endif()
if(DIMINISH_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "DIMINISH_BUILD_FUZZERS needs clang")
  endif()
  # libFuzzer sees which branches an input takes, in what reads input.
  add_compile_options(-fsanitize=fuzzer-no-link
    -fsanitize-coverage-allowlist=${PROJECT_SOURCE_DIR}/fuzz/coverage.txt)
endif()

# diminish_compile_together(TARGET FILE...): in a unity build up to 16 FILEs of this folder are one for the
# compiler, which reads the headers once for all of them. Names in their unnamed namespaces must differ.
function(diminish_compile_together target)
  if(NOT DIMINISH_UNITY_BUILD)
    return()
  endif()
  set(files "")
  foreach(file IN LISTS ARGN)
    file(STRINGS ${file} kernels LIMIT_COUNT 1 REGEX "hwy/foreach_target\\.h")
    if(NOT kernels) # which Highway compiles by their own names, once for each kind of CPU
      list(APPEND files ${file})
    endif()
  endforeach()
  list(LENGTH files count)
  if(count EQUAL 0)
    return()
  endif()
  file(RELATIVE_PATH room ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  list(GET files 0 first)
  get_filename_component(first ${first} NAME_WE)
  math(EXPR groups "(${count} + 15) / 16")
  set(index 0)
  foreach(file IN LISTS files)
    math(EXPR group "${index} * ${groups} / ${count} + 1")
    string(MAKE_C_IDENTIFIER "${room}_${first}_${group}" name)
    set_source_files_properties(${file} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${name})
    math(EXPR index "${index} + 1")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# diminish_compile_kernels_together(TARGET FILE...): the same for FILEs that Highway includes once for each kind of
# CPU. It includes what HWY_TARGET_INCLUDE says: here a file that includes all of them, each of which says itself.
function(diminish_compile_kernels_together target)
  if(NOT DIMINISH_UNITY_BUILD)
    return()
  endif()
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set(together ${CMAKE_CURRENT_BINARY_DIR}/kernels.cpp)
  set(own_name "#define HWY_TARGET_INCLUDE \"${together}\"\n")
  list(TRANSFORM ARGN REPLACE "(.+)" "#include \"\\1\"\n" OUTPUT_VARIABLE includes)
  string(CONCAT content ${own_name} "#include <hwy/foreach_target.h>\n" ${includes} "#undef HWY_TARGET_INCLUDE\n" ${own_name})
  file(CONFIGURE OUTPUT ${together} CONTENT "${content}" @ONLY)
  target_sources(${target} PRIVATE ${together})
  set_source_files_properties(${together} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES HEADER_FILE_ONLY ON)
endfunction()

# diminish_sources(FILE...): adds FILEs to the library. diminish_tests(FILE...): adds them to the tests.
function(diminish_sources)
  list(TRANSFORM ARGV PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  target_sources(diminish_objects PRIVATE ${ARGV})
  diminish_compile_together(diminish_objects ${ARGV})
endfunction()
function(diminish_tests)
  if(DIMINISH_BUILD_TESTS)
    list(TRANSFORM ARGV PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    target_sources(diminish_tests PRIVATE ${ARGV})
    diminish_compile_together(diminish_tests ${ARGV})
  endif()
endfunction()

# diminish_test_shards(TARGET COUNT [VARIABLE=VALUE...]): ctest runs TARGET's tests in COUNT processes, each its
# share of them, and shows what fails. A process a test would take minutes to start them all.
function(diminish_test_shards target count)
  foreach(shard RANGE 1 ${count})
    math(EXPR index "${shard} - 1")
    set(environment GTEST_TOTAL_SHARDS=${count} GTEST_SHARD_INDEX=${index} ${ARGN})
    add_test(NAME ${target}_${shard} COMMAND ${target} --gtest_brief=1)
    set_tests_properties(${target}_${shard} PROPERTIES TIMEOUT 1800 ENVIRONMENT "${environment}")
  endforeach()
endfunction()
