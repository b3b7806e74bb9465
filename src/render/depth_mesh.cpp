#include "render/depth_mesh.h"

#include <cmath>

#include "render/color_ray.h"
#include "render/sdct.h"

namespace diminish {
namespace {

/// To 1/256 pixel; ties to even, like the CPU's conversion instructions.
std::int32_t to_subpixels(float pixels) {
  return static_cast<std::int32_t>(std::lrint(pixels * sdct::subpixels));
}

}  // namespace

DepthMesh::DepthMesh(const RgbdCamera& camera, const Intrinsics& color)
    : camera_(camera),
      rays_(RayTable::of(camera.depth)),
      to_rgbd_color_(camera.color_from_depth),
      color_(Lens(color)),
      rgbd_color_(Lens(camera.color)) {}

MeshVertex DepthMesh::vertex(const Frame& frame, int column, int row,
                             const Eigen::Vector2f& color_ray) const {
  const std::uint16_t value = frame.depth(column, row);
  if (value == 0 || frame.depth_mask(column, row) != 0) return {};
  const float z = static_cast<float>(value) * static_cast<float>(camera_.depth_unit_m);
  const float x = rays_->x(row)[column] * z;
  const float y = rays_->y(row)[column] * z;

  float u = 0;
  float v = 0;
  if (!texture(color_ray, z, u, v) ||
      frame.color_mask(static_cast<int>(std::lrint(u)), static_cast<int>(std::lrint(v))) != 0) {
    return {};
  }

  const float color_z = frame.to_color.apply(2, x, y, z);
  if (!(color_z > sdct::near_plane_m)) return {};
  float px = 0;
  float py = 0;
  if (!color_.distort(frame.to_color.apply(0, x, y, z) / color_z,
                      frame.to_color.apply(1, x, y, z) / color_z, px, py) ||
      !(std::abs(px) < sdct::max_coordinate_px && std::abs(py) < sdct::max_coordinate_px)) {
    return {};
  }
  return {to_subpixels(px), to_subpixels(py), 1.F / color_z, u, v, z};
}

bool DepthMesh::texture(ImageView<std::uint16_t> depth, int column, int row, float& u,
                        float& v) const {
  const float z = static_cast<float>(depth(column, row)) * static_cast<float>(camera_.depth_unit_m);
  return texture((*rays_)(column, row), z, u, v);
}

bool DepthMesh::texture(const Eigen::Vector2f& ray, float z, float& u, float& v) const {
  const float x = ray.x() * z;
  const float y = ray.y() * z;
  const float rgbd_z = to_rgbd_color_.apply(2, x, y, z);
  if (!(rgbd_z > sdct::near_plane_m)) return false;
  const auto last_column = static_cast<float>(camera_.color.width - 1);
  const auto last_row = static_cast<float>(camera_.color.height - 1);
  return rgbd_color_.distort(to_rgbd_color_.apply(0, x, y, z) / rgbd_z,
                             to_rgbd_color_.apply(1, x, y, z) / rgbd_z, u, v) &&
         u >= 0 && u <= last_column && v >= 0 && v <= last_row;
}

Eigen::Vector3f DepthMesh::point_m(const Frame& frame, int column, int row) const {
  const float z =
      static_cast<float>(frame.depth(column, row)) * static_cast<float>(camera_.depth_unit_m);
  const float x = rays_->x(row)[column] * z;
  const float y = rays_->y(row)[column] * z;
  return {frame.to_color.apply(0, x, y, z), frame.to_color.apply(1, x, y, z),
          frame.to_color.apply(2, x, y, z)};
}

void DepthMesh::compute(const Frame& frame, Image<MeshVertex>& vertices) const {
  vertices.resize(frame.depth.width(), frame.depth.height());
  for (int row = 0; row < vertices.height(); ++row) {
    for (int column = 0; column < vertices.width(); ++column) {
      vertices(column, row) =
          vertex(frame, column, row, color_ray(frame.depth, *rays_, column, row));
    }
  }
}

}  // namespace diminish
