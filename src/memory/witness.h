#pragma once

#include <vector>

#include "core/rows.h"
#include "diminish/poses.h"
#include "memory/keyframe.h"
#include "memory/testimony_comparison.h"

namespace diminish {

/// Compares what is remembered with what the RGB-D cameras see now.
class Witness {
 public:
  Witness(const Rig& rig, const KeyframeGrid& grid);

  /// now: the testimonies of this frame.
  struct Inputs {
    const Keyframe& keyframe;
    const RigidTransform& color_from_keyframe;
    const std::vector<Testimony>& now;
    const Poses& poses;
    const Rect& region;  ///< of the picture; what lies outside is not judged
  };
  /// Copies the keyframe's depth without what has changed. gone: points that are gone for ever, in
  /// the keyframe's frame. Cost: 10 ns a place that is judged, and comparing testimonies there.
  void judge(const Inputs& inputs, Image<std::uint16_t>& depth, std::vector<Eigen::Vector3f>& gone);

  /// Of the keyframe's grid: what the last `judge` judged.
  const Rect& part() const { return part_; }
  /// By place of that part: not 0 where an RGB-D camera sees now what it saw then.
  const Mask& confirmed() const { return confirmed_; }

  /// Whether what RGB-D camera `k` sees at a place of its testimony was there when the keyframe of
  /// the last `judge` was taken.
  Verdict was_there(std::size_t k, std::int32_t place) const {
    const Verdicts& now = cameras_[k].now;
    return now.empty() ? Verdict::unknown : now.data()[place];
  }
  const TestimonyGrid& grid(std::size_t k) const { return cameras_[k].grid; }

 private:
  struct Camera {
    explicit Camera(const TestimonyGrid& grid_) : grid(grid_), comparison(grid) {}

    TestimonyGrid grid;
    TestimonyComparison comparison;
    bool looks = false;     ///< now
    bool is_asked = false;  ///< looks, and did so when the keyframe was taken
    FloatTransform from_keyframe{RigidTransform()};  ///< to the depth sensor's frame of now
    Rect then_part, now_part;  ///< of its testimonies: what they show of the region
    /// What has become of what the camera saw then; whether what it sees now was there.
    Verdicts then, now;
  };
  /// What lies in the region: of the keyframe's grid, and of each camera's testimonies.
  void find_parts(const Inputs& inputs);
  void judge_row(const Inputs& inputs, int y, Image<std::uint16_t>& depth,
                 std::vector<Eigen::Vector3f>& gone);

  KeyframeGrid grid_;
  Projection color_;
  Rect picture_;
  Rect part_;            ///< of the grid
  Mask confirmed_;       ///< of it, too
  float doubted_m_ = 0;  ///< nearer than that, times its doubt, a place is not shown
  std::vector<Camera> cameras_;
  std::vector<Eigen::Vector3f> gone_in_band_[most_bands];
};

}  // namespace diminish
