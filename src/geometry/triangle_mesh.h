#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <istream>
#include <vector>

namespace diminish {

/// A triangle mesh, metres.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

/// Reads the `v` and `f` lines of a Wavefront OBJ file. Faces with more than three corners are
/// split into fans, negative indices count from the end, and other lines are ignored. Throws Error
/// with file and line on malformed lines, on indices out of range, and if there are no faces.
TriangleMesh load_obj(const std::filesystem::path& file);
TriangleMesh read_obj(std::istream& stream, const std::filesystem::path& file);

}  // namespace diminish
