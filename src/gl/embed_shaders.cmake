# Writes OUTPUT, which defines shader_file() of gl/shader_files.h, from the files in FOLDER.
file(GLOB files ${FOLDER}/*)
list(SORT files)
set(entries "")
foreach(file ${files})
  get_filename_component(name ${file} NAME)
  file(READ ${file} text)
  string(APPEND entries "    {\"${name}\", R\"shader(${text})shader\"},\n")
endforeach()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "gl/shader_files.h"

#include <string>
#include <utility>

#include "diminish/error.h"

namespace diminish::gl {
namespace {

constexpr std::pair<std::string_view, std::string_view> files[] = {
@entries@};

}  // namespace

std::string_view shader_file(std::string_view name) {
  for (const auto& [file, text] : files) {
    if (file == name) return text;
  }
  throw Error("gl: there is no shader file '" + std::string(name) + "'");
}

}  // namespace diminish::gl
]] @ONLY)
