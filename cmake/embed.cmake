# diminish_embed(NAME FILE...): makes NAME.h and NAME.cpp with the files' contents and adds them to
# the library: `const std::map<std::string, std::string_view>& NAME()`, by file name.
if(CMAKE_SCRIPT_MODE_FILE)
  set(entries "")
  foreach(file ${FILES})
    file(READ ${file} content)
    get_filename_component(name ${file} NAME)
    string(APPEND entries "      {\"${name}\", R\"embedded(${content})embedded\"},\n")
  endforeach()
  file(WRITE ${OUTPUT} "#include \"${NAME}.h\"\n\nnamespace diminish {\n\nconst std::map<std::string, std::string_view>& ${NAME}() {\n  static const std::map<std::string, std::string_view> files = {\n${entries}  };\n  return files;\n}\n\n}  // namespace diminish\n")
  return()
endif()

set(DIMINISH_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(diminish_embed name)
  set(files ${ARGN})
  list(TRANSFORM files PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.h.new
    "#pragma once\n\n#include <map>\n#include <string>\n#include <string_view>\n\nnamespace diminish {\n\nconst std::map<std::string, std::string_view>& ${name}();\n\n}  // namespace diminish\n")
  configure_file(${CMAKE_CURRENT_BINARY_DIR}/${name}.h.new ${CMAKE_CURRENT_BINARY_DIR}/${name}.h COPYONLY)
  add_custom_command(OUTPUT ${source} VERBATIM
    COMMAND ${CMAKE_COMMAND} -DNAME=${name} "-DFILES=${files}" -DOUTPUT=${source} -P ${DIMINISH_EMBED_SCRIPT}
    DEPENDS ${files} ${DIMINISH_EMBED_SCRIPT})
  add_custom_target(diminish_${name} DEPENDS ${source})
  add_dependencies(diminish_objects diminish_${name})
  set_source_files_properties(${source} TARGET_DIRECTORY diminish_objects PROPERTIES GENERATED TRUE)
  target_sources(diminish_objects PRIVATE ${source})
  target_include_directories(diminish_objects PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
