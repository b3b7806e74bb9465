#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/turns.h"
#include "diminish/scan.h"
#include "memory/recall_merge.h"
#include "memory/scene_memory.h"
#include "scene/scene_fit.h"

namespace diminish {

/// Stage::memory and merging: shows what was seen earlier where it is better than what is seen now.
/// Several pipelines share one memory; each works on a frame of the same sequence.
class MemoryStage {
 public:
  explicit MemoryStage(const Rig& rig)
      : shared_(std::make_shared<Shared>(rig)), merge_(rig.color), fit_(rig.color) {}

  void share(MemoryStage& other) { shared_ = other.shared_; }
  void take_turn() { turn_.take(shared_->turns); }
  /// Does nothing if there is none.
  void end_turn() { turn_.end(); }

  /// Waits for this frame's turn and recalls.
  void recall(const RecallInputs& inputs);
  /// Then learns and ends the turn; at the same time draws what was recalled. inputs: as in
  /// recall(). samples, objects: of this frame. sample: makes the samples and refines inputs.poses;
  /// called if this frame is learnt from. Empty: that is done. report: comes empty.
  void learn(const RecallInputs& inputs, const SceneSamples& samples,
             const std::vector<OccluderReport>& objects, const std::function<void()>& sample,
             MemoryReport& report);
  /// Stage::merging. inputs: as in recall(). color_maps: of the RGB-D cameras.
  void merge(const RecallInputs& inputs, ColorMapsBySource color_maps,
             Reconstruction& reconstruction, MemoryReport& report);
  /// How well the scan's keyframe of which the last `merge` shows most fits the picture
  /// around the objects: as SceneFit. Nothing if it shows none, or there is too little texture.
  const std::optional<double>& background_fit() const { return background_fit_; }
  void forget();

  /// Fills the memory before the first frame. Throws Error (keyframes_of).
  void set_background(const Scan& scan, const Scene& scene);
  /// What is remembered after the frames so far. Throws Error (expect_world).
  Scan scan(const Scene& scene);

 private:
  struct Shared {
    explicit Shared(const Rig& rig_) : rig(rig_) {}

    Rig rig;
    Turns turns;
    std::optional<SceneMemory> memory;  ///< made when it is needed
  };
  /// What `work` returns, done when it is this stage's turn, which then ends.
  template <class Work>
  auto in_turn(const Work& work);

  /// pixels: how many each recollection shows as remembered.
  void find_background_fit(const RecallInputs& inputs, const std::vector<std::size_t>& pixels);

  std::shared_ptr<Shared> shared_;
  Turn turn_;
  Poses poses_;  ///< of this frame, anchored
  std::vector<Recollection> recollections_;
  std::size_t recalled_ = 0;  ///< that are used in this frame
  RecallMerge merge_;
  SceneFit fit_;
  SceneSamples around_;  ///< what a keyframe shows beside the objects
  std::vector<std::optional<double>> fits_;
  std::optional<double> background_fit_;
};

}  // namespace diminish
