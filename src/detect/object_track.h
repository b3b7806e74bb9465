#pragma once

#include <optional>
#include <vector>

#include "diminish/rigid_transform.h"

namespace diminish {

/// Where an object was when it was last seen, to tell where it is when nobody sees it for a moment.
class ObjectTrack {
 public:
  /// For how long its motion is believed to go on, and of how long a time it is the mean.
  static constexpr double longest_s = 0.5;
  static constexpr double motion_s = 0.3;

  /// x_in_frame = frame_from_object * x_in_object, of a frame that stands still; `is_world` says
  /// which. Times that go back, and another frame, begin anew.
  void add(double stamp_s, bool is_world, const RigidTransform& frame_from_object);

  /// Moved on from where it was last, without turning. Absent if it has not been seen for longer
  /// than that, or in another frame only.
  std::optional<RigidTransform> at(double stamp_s, bool is_world) const;

 private:
  struct Moment {
    double stamp_s;
    RigidTransform frame_from_object;
  };
  bool is_world_ = false;
  std::vector<Moment> moments_;  ///< the last ones, over motion_s
};

}  // namespace diminish
