#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "diminish/diminished_frame.h"
#include "memory/keyframe_store.h"
#include "memory/recollection.h"
#include "memory/rgbd_viewpoint.h"

namespace diminish {

/// What the user's camera has seen so far, and RGB-D cameras that move. Frames must come in order.
class SceneMemory {
 public:
  static constexpr std::size_t most_recalled = 3;

  explicit SceneMemory(const Rig& rig);
  ~SceneMemory() = default;
  SceneMemory(const SceneMemory&) = delete;
  SceneMemory& operator=(const SceneMemory&) = delete;

  /// Prepares what this frame is to be reminded of (at most `most_recalled`), and forgets what the
  /// RGB-D cameras see to be gone. inputs.poses: anchored. is_anchored: the world is where the
  /// first RGB-D camera stands. recollections: as many as are used. Returns their number.
  std::size_t recall(const RecallInputs& inputs, bool is_anchored,
                     std::vector<Recollection>& recollections);

  /// Takes a keyframe if there is something new; what that costs is spread over this frame and the
  /// next two, after which the keyframe is used. (They recall, so that the result does not depend
  /// on threads; within 0.1 s, however few frames come.) objects: the reports about the objects to
  /// remove. sample: as in MemoryStage::recall.
  void learn(const RecallInputs& inputs, const SceneSamples& samples,
             const std::vector<OccluderReport>& objects, const std::function<void()>& sample);

  /// All, the background too.
  void forget();

  /// Keyframes of an earlier recording; they are the oldest.
  void set_background(std::vector<Keyframe> keyframes);
  /// Oldest first. Completes the one that is pending.
  const std::vector<std::shared_ptr<Keyframe>>& all();

  /// With the one that is pending.
  std::size_t keyframes() const { return store_.size() + (pending_ != nullptr ? 1 : 0); }
  std::size_t bytes() const {
    return store_.bytes() + (pending_ != nullptr ? pending_->pending()->bytes() : 0);
  }

 private:
  /// An RGB-D camera as the user's, and its keyframes.
  struct Viewpoint {
    RgbdViewpoint view;
    KeyframeTaker taker;
  };
  void begin_anew();
  /// Whether an object is lost that was there a moment ago: it may be anywhere.
  bool has_just_lost(const std::vector<OccluderReport>& objects, double stamp_s);
  /// Whether the camera that is the world still stands where it stood.
  bool has_lost_its_world(const RecallInputs& inputs);
  /// An RGB-D camera that leaves a place where it stood for a while may have seen things change
  /// that its keyframe still shows: it is forgotten. The camera takes the next one two centimetres
  /// on.
  void leave_places(const RecallInputs& inputs);
  /// Who is to take a keyframe of this frame: the user's camera first. Nobody: nullptr.
  KeyframeTaker* find_due(const RecallInputs& inputs);
  KeyframeView view_of(const KeyframeTaker& taker, const RecallInputs& inputs,
                       const SceneSamples& samples);
  void look(const RecallInputs& inputs);
  /// The next one towards a keyframe, if one is pending.
  void take_step();

  Rig rig_;
  KeyframeGrid grid_;
  KeyframeTaker users_;
  std::vector<Viewpoint> viewpoints_;  ///< of each RGB-D camera
  KeyframeTaker* pending_ = nullptr;   ///< whose keyframe is not ready yet
  KeyframeStore store_;
  std::vector<KeyframeStore::Choice> chosen_;
  std::vector<TestimonyTaker> testimony_takers_;
  std::vector<Testimony> testimonies_;
  bool has_looked_ = false;      ///< in this frame
  double last_stamp_s_ = 0;      ///< of any frame
  std::vector<double> found_s_;  ///< when each object was last found
};

/// result: the poses with a world: if none is known, it is where the first RGB-D camera's depth
/// sensor is, which then must stand still.
void anchor(const Poses& poses, Poses& result);

}  // namespace diminish
