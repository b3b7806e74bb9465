#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/rig.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// A depth pixel as the colour camera sees it.
struct MeshVertex {
  std::int32_t x = 0;   ///< column in the colour camera's image, in 1/256 pixels
  std::int32_t y = 0;   ///< row, likewise
  float inverse_z = 0;  ///< 1 / z in the colour camera's frame, 1/m; 0: not a vertex
  float u = 0;          ///< column in the RGB-D camera's own colour image
  float v = 0;          ///< row, likewise
  float depth_m = 0;    ///< z in the depth sensor's frame

  bool valid() const { return inverse_z > 0; }
};

/// Turns one RGB-D camera's depth images into vertices. Keeps what depends on the camera alone.
class DepthMesh {
 public:
  /// color: the user's colour camera, into which the vertices are projected.
  DepthMesh(const RgbdCamera& camera, const Intrinsics& color);

  /// masks: this camera's.
  struct Frame {
    ImageView<std::uint16_t> depth;
    const Mask& depth_mask;
    const Mask& color_mask;
    FloatTransform to_color;
  };
  /// The vertex of a depth pixel, by rule 1 of sdct.h; its colour is looked up where it lies.
  MeshVertex vertex(const Frame& frame, int column, int row) const {
    return vertex(frame, column, row, (*rays_)(column, row));
  }
  /// The place in the RGB-D camera's colour image of a depth pixel with a measurement. False if it
  /// has none.
  bool texture(ImageView<std::uint16_t> depth, int column, int row, float& u, float& v) const;
  /// The vertices of all depth pixels; their colours are looked up along color_ray.
  void compute(const Frame& frame, Image<MeshVertex>& vertices) const;

  /// The point that a depth pixel measures, in the colour camera's frame, masked or not.
  Eigen::Vector3f point_m(const Frame& frame, int column, int row) const;

 private:
  MeshVertex vertex(const Frame& frame, int column, int row,
                    const Eigen::Vector2f& color_ray) const;
  bool texture(const Eigen::Vector2f& ray, float z, float& u, float& v) const;

  RgbdCamera camera_;
  std::shared_ptr<const RayTable> rays_;
  FloatTransform to_rgbd_color_;
  Projection color_;
  Projection rgbd_color_;
};

}  // namespace diminish
