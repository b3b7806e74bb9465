#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/turns.h"
#include "diminish/diminished_frame.h"
#include "diminish/frame_set.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "pose/depth_scale.h"
#include "pose/marker_agreement.h"
#include "pose/object_place.h"

namespace diminish {

/// What is shown where the background does not fit the picture around it: a false background is
/// worse than the real object. Several pipelines share what they hold, each with a frame of the
/// same sequence.
class Doubt {
 public:
  /// A picture that is held for longer is no longer where the user looks.
  static constexpr double longest_hold_s = 0.5;

  void share(Doubt& other) { shared_ = other.shared_; }
  void take_turn() { turn_.take(shared_->turns); }
  /// Does nothing if there is none.
  void end_turn() { turn_.end(); }
  void forget();

  /// What a frame shows of its set-up; in lists, for each RGB-D camera.
  struct Evidence {
    const std::vector<std::optional<MarkerScale>>& scales;
    const std::vector<std::optional<MarkerShift>>& shifts;
    const std::vector<std::optional<PlaceOfObject>>& places;
    const std::vector<std::optional<double>>& late_s;  ///< (StreamDelay)
    std::optional<double> focal_factor;  ///< the colour camera's is better so (LensTrial)
  };
  /// From `report.fit` and the evidence: sets `report.in_doubt`, and says in `report.messages` why,
  /// and what to do.
  static void judge(const Rig& rig, const Options& options, const Evidence& evidence,
                    FrameReport& report);
  /// The same, of what is shown of a scan (MemoryStage::background_fit).
  static void judge_background(const std::optional<double>& fit, const Options& options,
                               FrameReport& report);
  /// Shows what the option `on_doubt` says. With `hold`, waits for its turn and ends it. Returns
  /// whether that changed the result.
  bool act(const FrameSet& frame, const Options& options, DiminishedFrame& result);

 private:
  /// The last one without doubt.
  struct Shared {
    Turns turns;
    double stamp_s = 0;
    Image<Bgr> picture;  ///< empty: none
    Mask mask;
    Image<std::uint8_t> provenance;
    Rect objects;
  };
  bool hold(const FrameSet& frame, DiminishedFrame& result);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  Turn turn_;
};

}  // namespace diminish
