#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "bars/bar.h"
#include "bars/bar_views.h"
#include "core/turns.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// The bars of earlier frames, so that one whose edge is not found in a frame is looked for where
/// it was. Kept in the world's frame. Several pipelines share one; each works on a frame of the
/// same sequence.
class KnownBars {
 public:
  void share(KnownBars& other) { shared_ = other.shared_; }
  void take_turn() { turn_.take(shared_->turns); }
  /// Does nothing if there is none.
  void end_turn() { turn_.end(); }
  void forget();

  /// Those that run into the mask, as this frame's picture would show them. Waits for its turn.
  void recall(const RigidTransform& color_from_world, const BarViews& views, const Mask& occlusion,
              std::vector<Bar>& bars);
  /// Keeps what was found; others, unless what was found excludes them, for some more frames. Ends
  /// the turn.
  void keep(const RigidTransform& color_from_world, const BarViews& views,
            const std::vector<Bar>& bars);

 private:
  struct Known {
    std::array<Eigen::Vector3f, 2> left, right;  ///< of its edges: outside the mask, inside
    Eigen::Vector3f normal;                      ///< of its plane, towards the user
    int frames_missed = 0;
  };
  struct Shared {
    Turns turns;
    std::vector<Known> bars;
  };
  /// In this frame's picture; nothing if it is not in view.
  static std::optional<Bar> in_picture(const Known& known, const RigidTransform& color_from_world,
                                       const BarViews& views);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  Turn turn_;
};

}  // namespace diminish
