#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rig.h"
#include "diminish/rigid_transform.h"
#include "diminish/scene_samples.h"
#include "geometry/point_projection.h"
#include "geometry/point_rows.h"
#include "geometry/ray_table.h"
#include "memory/testimony.h"

namespace diminish {

/// How an RGB-D camera saw one of a keyframe's places when the keyframe was taken.
class Sight {
 public:
  enum Kind : std::uint32_t {
    aside,    ///< out of its view
    through,  ///< nothing was there, for this camera: an error of calibration
    same,     ///< it saw the place
    hidden,   ///< it saw something nearer, or nothing
  };

  Sight() = default;
  /// place: of the camera's testimony, counted row by row.
  Sight(Kind kind, std::int32_t place) : bits_(static_cast<std::uint32_t>(place) << 2 | kind) {}
  Kind kind() const { return static_cast<Kind>(bits_ & 3); }
  std::int32_t place() const { return static_cast<std::int32_t>(bits_ >> 2); }

 private:
  std::uint32_t bits_ = 0;
};

/// What a camera saw at one moment, apart from the objects to remove: the user's, or an RGB-D
/// camera's colour sensor through the user's lens (RgbdViewpoint). It is drawn like an RGB-D
/// camera's images; `depth` is in the camera's own view, on KeyframeGrid.
struct Keyframe {
  double stamp_s = 0;
  bool is_background = false;       ///< of a scan: its time says nothing, and it does not age
  std::optional<std::size_t> rgbd;  ///< the RGB-D camera; nothing: the user's
  bool is_current = false;          ///< that camera still stands there: it shows as much now
  RigidTransform color_from_world;
  std::vector<std::optional<RigidTransform>> color_from_depth;  ///< of each RGB-D camera
  Image<Bgr> picture;
  /// KeyframeGrid::unit_m; 0 where nothing may be shown: objects to remove, what is gone.
  Image<std::uint16_t> depth;
  Mask doubt;  ///< by place: how much of the depth may be wrong, in units of doubt_unit
  std::vector<Testimony> testimonies;  ///< of each RGB-D camera

  // What follows from that, for as long as it is kept: by KeyframePreparation.
  std::vector<Image<Sight>> sights;  ///< of each RGB-D camera, by place; empty without a testimony
  Image<float> overview_m;           ///< on KeyframeGrid's overview; 0: nothing may be shown
  /// By place: when an RGB-D camera last saw the surface unchanged; seconds after `stamp_s`.
  Image<float> confirmed_s;
  std::vector<SceneSample> samples;  ///< in the keyframe's frame

  /// Whether its pose was measured as the user's is now, so that both are wrong alike.
  bool is_users() const { return !rgbd && !is_background; }
  std::size_t bytes() const;
};

/// Of Keyframe::doubt.
inline constexpr float doubt_unit = 1.F / 255;

/// The places of the picture for which a keyframe has depth: every `step`-th pixel, row by row.
class KeyframeGrid {
 public:
  static constexpr double unit_m = 0.0005;
  /// Places along a row are fewer.
  static constexpr int most_columns = 512;

  explicit KeyframeGrid(const Intrinsics& color);

  int step() const { return step_; }
  /// The grid as a camera's picture: its pixels are the grid's places.
  const Intrinsics& intrinsics() const { return grid_; }
  /// An RGB-D camera with the picture as its colours and the grid as its depth image.
  RgbdCamera camera() const;

  static float depth_m(std::uint16_t depth) {
    return static_cast<float>(depth) * static_cast<float>(unit_m);
  }
  /// 0 if it is too far away.
  static std::uint16_t units(float depth_m) {
    const float units = depth_m / static_cast<float>(unit_m);
    return static_cast<std::uint16_t>(units < 65535 ? std::lrint(units) : 0);
  }
  /// The point at a place, in the keyframe's frame. depth: not 0.
  Eigen::Vector3f point_m(int x, int y, std::uint16_t depth) const {
    const float z = depth_m(depth);
    return {ray(x, y).x() * z, ray(x, y).y() * z, z};
  }
  Eigen::Vector2f ray(int x, int y) const { return (*rays_)(x, y); }
  const RayTable& rays() const { return *rays_; }
  const Projection& lens() const { return lens_; }
  /// The picture's colours at the places.
  void sample(ImageView<Bgr> picture, Image<Bgr>& colors) const;

  /// Every so many places: enough to tell what a keyframe shows.
  static constexpr int overview_step = 4;
  const RayTable& overview_rays() const { return *overview_rays_; }

 private:
  Intrinsics color_;
  int step_;
  Intrinsics grid_;
  Projection lens_;  ///< of the grid
  std::shared_ptr<const RayTable> rays_, overview_rays_;
};

/// How far around the objects to remove a keyframe holds nothing: a cell of the grid, and what
/// their edges shine onto.
constexpr int object_margin_px(int grid_step) {
  return grid_step + 6;
}

/// How far the depths of the same surface may be apart as two cameras see it.
inline constexpr DepthNoise between_cameras{0.03F, 0.006F};

}  // namespace diminish
