#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "diminish/diminished_frame.h"
#include "memory/keyframe_depth.h"
#include "memory/keyframe_store.h"
#include "memory/novelty.h"
#include "memory/recollection.h"

namespace diminish {

/// What the user's camera has seen so far. Frames must come in order.
class SceneMemory {
 public:
  static constexpr std::size_t most_recalled = 3;

  explicit SceneMemory(const Rig& rig);

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
  std::size_t keyframes() const { return store_.size() + (pending_.steps > 0 ? 1 : 0); }
  std::size_t bytes() const {
    return store_.bytes() + (pending_.steps > 0 ? pending_.keyframe->bytes() : 0);
  }

 private:
  void begin_anew();
  bool is_worth_a_keyframe(const RecallInputs& inputs) const;
  /// Whether an object is lost that was there a moment ago: it may be anywhere.
  bool has_just_lost(const std::vector<OccluderReport>& objects, double stamp_s);
  /// Whether the camera cannot have come here since the last frame: it was moved between two
  /// recordings, or a pose is wrong.
  bool has_jumped(const RigidTransform& color_from_world, double elapsed_s) const;
  /// Whether the camera that is the world still stands where it stood.
  bool has_lost_its_world(const RecallInputs& inputs);
  void look(const RecallInputs& inputs);
  /// The next one towards a keyframe, if one is pending.
  void take_step();
  void leave_out_objects(Keyframe& keyframe);

  Rig rig_;
  KeyframeGrid grid_;
  KeyframeDepth depth_;
  Novelty novelty_;
  KeyframeStore store_;
  std::vector<KeyframeStore::Choice> chosen_;
  std::vector<TestimonyTaker> takers_;
  std::vector<Testimony> testimonies_;
  /// A keyframe that is not ready yet, of the frame that gave it.
  struct Pending {
    int steps = 0;  ///< that are left
    std::shared_ptr<Keyframe> keyframe;
    Mask objects;
    bool is_uncertain = false;
  };
  Pending pending_;
  std::vector<std::uint8_t> object_columns_;
  bool has_looked_ = false;                        ///< in this frame
  bool has_jumped_ = false;                        ///< since the last frame
  std::optional<RigidTransform> last_from_world_;  ///< the colour camera's pose in the last frame
  double last_stamp_s_ = 0;                        ///< of any frame
  double last_keyframe_s_ = 0;
  std::optional<RigidTransform> last_keyframe_from_world_;  ///< nothing: none was taken
  Rect last_objects_;                                       ///< in the last keyframe
  std::vector<double> found_s_;                             ///< when each object was last found
};

/// result: the poses with a world: if none is known, it is where the first RGB-D camera's depth
/// sensor is, which then must stand still.
void anchor(const Poses& poses, Poses& result);

}  // namespace diminish
