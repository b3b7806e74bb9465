#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diminish/rigid_transform.h"
#include "ros/messages.h"

namespace diminish::ros {

/// The frames of /tf and /tf_static in time: of each frame, where it was in its parent during the
/// last ten seconds. At most a thousand frames with 512 transforms each; what is beyond is left
/// out, the oldest first.
class TransformBuffer {
 public:
  /// Transforms at their stamps' times plus `offset_s`. One that is more than ten seconds earlier
  /// than its frame's newest makes the frame begin anew: the sender's clock was set back.
  void add(const TfMessage& message, double offset_s);
  /// Of /tf_static: true at all times, until it is said anew.
  void add_static(const TfMessage& message);

  /// What is known of a transform at a time.
  struct Found {
    enum class Kind {
      known,    ///< interpolated between two that are at most `most_gap_s` apart
      not_yet,  ///< the newest is earlier
      lost,     ///< it began later, or there was a longer gap
      unknown,  ///< the two frames are not connected
    };
    Kind kind = Kind::unknown;
    RigidTransform to_from_from;
    std::string frame;    ///< whose place in its parent is missing
    double newest_s = 0;  ///< of that frame; `not_yet`
  };
  /// Of the frames on the way, each is interpolated on its own: its position along a line, its
  /// rotation about one axis. Cost: microseconds.
  Found find(const std::string& to, const std::string& from, double time_s,
             double most_gap_s) const;

  std::size_t frames() const { return frames_.size(); }

 private:
  struct Moment {
    double time_s = 0;
    RigidTransform parent_from_child;
  };
  struct Frame {
    std::string parent;
    bool is_static = false;
    std::vector<Moment> moments;  ///< in the order of time
  };
  Frame* frame_of(const TransformStamped& transform);

  std::map<std::string, Frame> frames_;
};

}  // namespace diminish::ros
