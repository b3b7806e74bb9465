#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/turns.h"
#include "diminish/diminished_frame.h"
#include "diminish/intrinsics.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"
#include "scene/background_planes.h"

namespace diminish {

/// Keeps what is invented steady: where the last frame invented the same place of the scene, the
/// two are mixed, so that a filling that changes its mind from frame to frame fades instead of
/// flickering. Places are followed where their depth is known: on the background's planes and on
/// completed sides. Several pipelines share one; each works on a frame of the same sequence.
class SteadyInventions {
 public:
  explicit SteadyInventions(const Intrinsics& color)
      : lens_(Lens(color)), rays_(RayTable::of(color)) {}

  void share(SteadyInventions& other) { shared_ = other.shared_; }
  void take_turn() { turn_.take(shared_->turns); }
  /// Does nothing if there is none.
  void end_turn() { turn_.end(); }
  void forget();

  struct Inputs {
    double stamp_s;
    const std::optional<RigidTransform>& color_from_world;
    const Rect& objects;                         ///< their box in the picture
    const std::vector<BackgroundPlane>* planes;  ///< null: not looked for
  };
  /// Changes `result.picture` where `result.provenance` is inpainted or estimated. Waits for its
  /// turn and ends it. Cost: 3 ns an invented pixel.
  void steady(const Inputs& inputs, DiminishedFrame& result);

 private:
  /// The last frame.
  struct Shared {
    Turns turns;
    double stamp_s = 0;
    std::optional<RigidTransform> color_from_world;  ///< none: there was none
    Rect part;                                       ///< of the picture that is kept
    Image<Bgra> picture;                             ///< alpha: 255 where it was invented
  };
  void mix(const Inputs& inputs, DiminishedFrame& result) const;
  void keep(const Inputs& inputs, const DiminishedFrame& result);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  Turn turn_;
  Projection lens_;
  std::shared_ptr<const RayTable> rays_;
};

}  // namespace diminish
