#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "diminish/scene_samples.h"
#include "diminish/surfaces.h"
#include "geometry/ray_grid.h"
#include "scene/background_planes.h"
#include "scene/cast_shadow.h"
#include "scene/shadow_search.h"

namespace diminish {

/// The shadows that the objects to remove cast on the background's planes. Everything that the
/// visible part of the objects cannot have caused stays: other objects' shadows, texture.
class CastShadows {
 public:
  /// Light changes little from pixel to pixel, so it is looked up only at every node_px-th pixel of
  /// every node_rows_px-th row.
  static constexpr int node_px = 16;
  static constexpr int node_rows_px = 8;
  /// The lowest part of something on a plane is labelled as the plane. So shadows fade between this
  /// and twice this times the depth's error bound.
  static constexpr float fading_height = 0.6F;

  explicit CastShadows(const Intrinsics& color);

  /// Finds the shadows. samples, object_points_m: in the colour camera's frame. Cost: one to three
  /// milliseconds; planes are searched at the same time.
  void find(const std::vector<BackgroundPlane>& planes, const std::vector<SceneSample>& samples,
            const std::vector<Eigen::Vector3f>& object_points_m);
  void clear() { shadow_count_ = 0; }
  /// Whether there are any shadows.
  bool any() const { return shadow_count_ > 0; }
  std::span<const CastShadow> shadows() const { return {shadows_.data(), shadow_count_}; }
  /// The box of the shadows in the colour camera's picture.
  Rect bounds() const;
  /// Fills `surfaces.light`; the labels are there. Shadows end where something stands on their
  /// plane.
  void shade(const Reconstruction& reconstruction, Surfaces& surfaces);
  const RayGrid& rays() const { return rays_; }

 private:
  static Eigen::Array3f dark_at(const CastShadow& cast, const Eigen::Vector2f& ray);
  void find_nodes(const Rect& region);
  void shade_row(int y, const Image<float>& depth_m, Surfaces& surfaces) const;

  Lens lens_;
  RayGrid rays_;
  std::vector<ShadowSearch> searches_;   ///< by plane
  std::vector<std::uint8_t> are_found_;  ///< likewise
  std::vector<CastShadow> shadows_;      ///< the first shadow_count_ are this frame's
  std::size_t shadow_count_ = 0;
  Rect nodes_box_;  ///< the nodes around the region, counted from the picture's corner
  /// By shadow: dark_at, and the height above the plane per metre of z.
  std::array<Image<Eigen::Array4f>, BackgroundPlanes::most_planes> nodes_;
  Mask is_shaded_;  ///< by block of pixels between four nodes
};

}  // namespace diminish
