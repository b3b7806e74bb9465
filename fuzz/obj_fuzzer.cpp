#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "diminish/error.h"
#include "geometry/triangle_mesh.h"

/// Any bytes are either a mesh whose triangles have vertices, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    const TriangleMesh mesh = read_obj(stream, "fuzz.obj");
    const int vertex_count = static_cast<int>(mesh.vertices.size());
    for (const auto& triangle : mesh.triangles) {
      for (const int vertex : triangle) {
        if (vertex < 0 || vertex >= vertex_count) std::abort();
      }
    }
    if (mesh.triangles.empty()) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
