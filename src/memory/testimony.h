#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "depth/depth_noise.h"
#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/rigid_transform.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// What an RGB-D camera saw at one moment, apart from the objects to remove, at every `step`-th
/// pixel of its depth image.
struct Testimony {
  static constexpr int step = 2;

  bool is_given = false;  ///< it had images and a pose
  RigidTransform depth_from_world;
  Image<float> depth_m;  ///< 0: not measured, or on an object
  Image<Bgr> color;      ///< of its colour sensor at these points; only where there is depth
};

/// Whether another testimony of the same camera confirms what one saw.
enum class Verdict : std::uint8_t {
  unknown,    ///< the other does not see the place
  same,       ///< it sees the same surface
  absent,     ///< it looks through the place
  recolored,  ///< it sees the surface, in other colours
  gone,       ///< it looks through the place beyond doubt
};
inline bool is_changed(Verdict verdict) {
  return verdict >= Verdict::absent;
}
using Verdicts = Image<Verdict>;  ///< on a testimony's grid

/// Takes one RGB-D camera's testimonies and compares them. Both have the same errors of
/// calibration, so that small changes show.
class TestimonyTaker {
 public:
  explicit TestimonyTaker(const RgbdCamera& camera);

  /// masks: this camera's. Cost: 30 ns per point.
  void take(const RgbdFrame& images, const std::optional<RigidTransform>& depth_from_world,
            const Mask& depth_mask, const Mask& color_mask, Testimony& testimony) const;

  /// What each says of the other, in a part of each; unknown elsewhere. A camera that stands still
  /// is compared pixel by pixel, whatever its poses say. Cost: 0.1 us per point.
  struct Side {
    const Testimony& testimony;
    Rect part;
    Verdicts& verdicts;
  };
  void compare(const Side& a, const Side& b) const;

  /// Of testimonies.
  Rect grid() const {
    constexpr int step = Testimony::step;
    return {0, 0, (camera_.depth.width - 1) / step + 1, (camera_.depth.height - 1) / step + 1};
  }

  const Projection& depth_lens() const { return depth_; }

 private:
  /// The point at depth `z` of a place of the grid, in the depth sensor's frame.
  Eigen::Vector3f point_m(int x, int y, float z) const {
    const Eigen::Vector2f ray = (*rays_)(x * Testimony::step, y * Testimony::step);
    return {ray.x() * z, ray.y() * z, z};
  }
  struct Tolerance {
    float depth = 2;   ///< times the sensor's usual noise
    float color = 20;  ///< levels
    int reach = 1;     ///< neighbours that may be meant instead; the camera moves if more than 1
  };
  struct Difference {
    Verdict verdict = Verdict::unknown;
    float depth = 0, color = 0;  ///< in the units of Tolerance
  };
  Difference compare(const Testimony& a, const Testimony& b, const FloatTransform& b_from_a,
                     const Tolerance& tolerance, int x, int y) const;
  /// How many of some samples are the same. Sets the tolerance by the noise that these show.
  int count_same(const Testimony& a, const Testimony& b, const FloatTransform& b_from_a,
                 Tolerance& tolerance) const;
  void judge(const Side& side, const Testimony& other, const FloatTransform& other_from_side,
             const Tolerance& tolerance) const;

  RgbdCamera camera_;
  std::shared_ptr<const RayTable> rays_;  ///< of the whole depth image
  Projection depth_, color_;
  FloatTransform color_from_depth_;
};

}  // namespace diminish
