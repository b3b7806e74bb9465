#include "geometry/triangle_mesh.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>

#include "core/limits.h"
#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr std::size_t max_file_bytes = 256 << 20;

/// Where the reader is, for messages.
struct Place {
  const std::filesystem::path& file;
  int line = 0;

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(Error::input, fmt::format("{}:{}: {}", file.string(), line, message));
  }
};

Eigen::Vector3d read_vertex(const std::vector<std::string_view>& words, const Place& place) {
  if (words.size() < 4) place.fail("expected three coordinates");
  Eigen::Vector3d vertex;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = words[static_cast<std::size_t>(axis) + 1];
    const auto number = parse_number(word);
    if (!number) place.fail("expected a number, got '" + printable(word) + "'");
    if (std::abs(*number) > largest_coordinate_m) {
      place.fail("expected metres, got more than a kilometre: '" + printable(word) + "'");
    }
    vertex[axis] = *number;
  }
  return vertex;
}

/// corner: "7", "7/1", "7/1/3" or "7//3"; only the vertex's index counts.
int read_corner(std::string_view corner, int vertex_count, const Place& place) {
  int index = 0;
  const char* end = corner.data() + corner.size();
  const auto [stop, error] = std::from_chars(corner.data(), end, index);
  if (error != std::errc() || (stop != end && *stop != '/') || index == 0) {
    place.fail("expected a vertex's index, got '" + printable(corner) + "'");
  }
  const int from_start = index > 0 ? index - 1 : vertex_count + index;
  if (from_start < 0 || from_start >= vertex_count) {
    place.fail(fmt::format("vertex {} of {}", index, vertex_count));
  }
  return from_start;
}

void add_face(const std::vector<std::string_view>& words, const Place& place, TriangleMesh& mesh) {
  if (words.size() < 4) place.fail("expected a face of at least three corners");
  const int vertex_count = static_cast<int>(mesh.vertices.size());
  const int first = read_corner(words[1], vertex_count, place);
  int previous = read_corner(words[2], vertex_count, place);
  for (std::size_t i = 3; i < words.size(); ++i) {
    const int corner = read_corner(words[i], vertex_count, place);
    mesh.triangles.push_back({first, previous, corner});
    previous = corner;
  }
}

}  // namespace

TriangleMesh load_obj(const std::filesystem::path& file) {
  std::istringstream stream(read_text_file(file, max_file_bytes));
  return read_obj(stream, file);
}

TriangleMesh read_obj(std::istream& stream, const std::filesystem::path& file) {
  TriangleMesh mesh;
  Place place{file};
  for (std::string line; std::getline(stream, line);) {
    ++place.line;
    const auto words = split_words(std::string_view(line).substr(0, line.find('#')));
    if (words.empty()) continue;
    if (words[0] == "v") mesh.vertices.push_back(read_vertex(words, place));
    if (words[0] == "f") add_face(words, place, mesh);
  }
  if (mesh.triangles.empty())
    throw Error(Error::input, file.string() + ": expected at least one face");
  return mesh;
}

}  // namespace diminish
