#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "geometry/depth_view.h"
#include "geometry/ray_grid.h"
#include "geometry/ray_table.h"

namespace diminish {

/// What the cameras say of places where a bar may be, or another surface without depth. Points are
/// in the colour camera's frame.
class BarViews {
 public:
  explicit BarViews(const Rig& rig);

  /// Looks at this frame, which must outlive all other calls.
  void begin(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks);

  enum class Place : std::uint8_t {
    bare,     ///< no depth was measured there
    solid,    ///< just this depth was measured, as steel's few returns have it
    seen,     ///< a camera measures what is behind it
    unknown,  ///< no camera sees the place
  };
  Place look_at(const Eigen::Vector3f& point_m) const;
  /// The same of a few points.
  using Places = std::array<Place, DepthView::few>;
  void look_at(const PointRow& points, Places& places) const;

  std::size_t size() const { return cameras_.size(); }
  /// The grey level in camera k's picture, 0 to 255; nothing outside it or on an object.
  std::optional<float> level(std::size_t k, const Eigen::Vector3f& point_m) const;
  /// Calls visit(i, depth) for those of a few points at which camera k has no depth.
  template <class Visit>
  void for_each_bare(std::size_t k, const PointRow& points, const Visit& visit) const {
    cameras_[k].depth.for_each_bare(points, visit);
  }
  /// Whether there are nearer and further depths around the gap in camera k's image (within the
  /// errors of a pose), or the same. bare: by for_each_bare.
  bool is_in_gap(std::size_t k, const DepthView::Depth& bare) const;
  /// The colour in camera k's picture; nothing outside it or on an object.
  std::optional<Eigen::Array3f> color(std::size_t k, const Eigen::Vector3f& point_m) const;
  /// Where camera k is; nothing if it has no pose or no image.
  std::optional<Eigen::Vector3f> centre(std::size_t k) const;

  /// The ray (x, y, 1) of a place in the user's picture.
  Eigen::Vector3f ray(const Eigen::Vector2f& at) const;
  Eigen::Vector3f ray(int x, int y) const { return (*pixel_rays_)(x, y).homogeneous(); }
  std::optional<Eigen::Vector2f> project(const Eigen::Vector3f& point_m) const;
  /// Pixels of the user's picture to one of the coarsest depth image's, at any distance that is
  /// alike for both cameras.
  float depth_pixel_px() const { return depth_pixel_px_; }

 private:
  struct Camera {
    explicit Camera(const RgbdCamera& camera)
        : rig(camera), depth(camera), color_lens(Lens(camera.color)) {}

    RgbdCamera rig;
    DepthView depth;  ///< empty: it takes no part
    Projection color_lens;
    ImageView<Bgr> color;
    ImageView<std::uint8_t> color_objects;
    FloatTransform color_from_user{RigidTransform{}};
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  };
  /// Where a point is in the camera's picture, with neighbours on all sides; nothing outside it or
  /// on an object.
  static std::optional<Eigen::Vector2f> in_picture(const Camera& camera,
                                                   const Eigen::Vector3f& point_m);
  /// What is said of a place, when one more camera has been asked.
  static Place add(Place so_far, const DepthView::Depth& depth);

  std::vector<Camera> cameras_;
  Projection user_;
  RayGrid rays_;
  std::shared_ptr<const RayTable> pixel_rays_;
  float depth_pixel_px_ = 1;
};

}  // namespace diminish
