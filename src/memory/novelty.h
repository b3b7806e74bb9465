#pragma once

#include "memory/keyframe.h"
#include "memory/surroundings.h"

namespace diminish {

/// Keeps what has just come out of keyframes until it has stayed for a while: a hand that passes,
/// or an object to remove that no detector finds yet, is not to be remembered.
class Novelty {
 public:
  static constexpr double stay_s = 2;

  explicit Novelty(const KeyframeGrid& grid) : grid_(grid) {}

  /// Compares with the frame of the last call. Clears the keyframe's depth where something is
  /// nearer or looks different than before and has not stayed yet. What was behind something
  /// is taken at once, and so is what was not seen before; the latter not if is_uncertain: an
  /// object to remove may be anywhere.
  void filter(bool is_uncertain, Keyframe& keyframe);

  void forget() { depth_m_.resize(0, 0); }

 private:
  KeyframeGrid grid_;
  // Of the last keyframe, with what was cleared.
  RigidTransform color_from_world_;
  Image<float> depth_m_;
  Image<Bgr> color_;
  Image<double> since_s_;  ///< the time from which on each place has looked like that
  Surroundings around_;
  Image<double> now_since_s_;
  Image<float> now_depth_m_;
  Image<Bgr> now_color_;
};

}  // namespace diminish
