#pragma once

#include <vector>

#include "diminish/poses.h"
#include "memory/keyframe.h"

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
  /// the keyframe's frame.
  void judge(const Inputs& inputs, Image<std::uint16_t>& depth, std::vector<Eigen::Vector3f>& gone);

  /// Whether what RGB-D camera `k` sees at a point was there when the keyframe of the last `judge`
  /// was taken. x_in_depth: in the frame of its depth sensor.
  Verdict was_there(std::size_t k, const Eigen::Vector3f& x_in_depth) const;

 private:
  struct Camera {
    TestimonyTaker taker;
    /// What has become of what the camera saw then; whether what it sees now was there.
    Verdicts then, now;
  };
  struct View;
  /// Visits some of the keyframe's points that lie in a part of the picture.
  template <class Visit>
  void for_each_in_part(const Keyframe& keyframe, const FloatTransform& to_color, const Rect& part,
                        const Visit& visit) const;
  bool has_changed(const View& view, const Inputs& inputs, const Eigen::Vector3f& point,
                   bool& is_gone) const;

  KeyframeGrid grid_;
  Projection color_;
  std::vector<Camera> cameras_;
};

}  // namespace diminish
