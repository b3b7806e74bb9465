#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "memory/keyframe_depth.h"
#include "memory/novelty.h"
#include "memory/recall_inputs.h"

namespace diminish {

/// What may become a keyframe: what a camera sees in a frame, through the user's lens.
struct KeyframeView {
  const Poses& poses;  ///< with this camera in place of the user's
  ImageView<Bgr> picture;
  const Mask& objects;     ///< to remove, in the picture
  const Rect& object_box;  ///< around them
  const SceneSamples& samples;
  std::span<const InversePlane> planes = {};  ///< RecallInputs::planes
};

/// Whether a camera sees something else now: from 2 cm or one degree on, times `reach`.
bool has_moved(const RigidTransform& before_from_world, const RigidTransform& now_from_world,
               double reach = 1);

/// Takes the keyframes of one camera.
class KeyframeTaker {
 public:
  /// rgbd: which RGB-D camera; nothing: the user's.
  KeyframeTaker(const Rig& rig, const KeyframeGrid& grid, std::optional<std::size_t> rgbd);

  /// Of each frame, as far as the pose is known.
  void follow(const RigidTransform& color_from_world, double stamp_s);
  /// Whether the camera cannot have come here since the last frame: it was moved between two
  /// recordings, or a pose is wrong.
  bool has_jumped() const { return has_jumped_; }
  /// Where it was followed to: when the camera has moved; the user's also when the objects have, or
  /// some time has passed. object_box: KeyframeView's.
  bool is_due(const Rect& object_box) const;

  /// Begins a keyframe; what that costs is spread over this call and two steps, between which other
  /// frames may come. testimonies: of this frame. is_uncertain: Novelty::filter. keyframe: to fill.
  void begin(const KeyframeView& view, const RecallInputs& inputs,
             const std::vector<Testimony>& testimonies, bool is_uncertain,
             std::shared_ptr<Keyframe> keyframe);
  /// The one that is not ready yet, or nothing.
  const Keyframe* pending() const { return keyframe_.get(); }
  /// The next step of the pending one. Returns it when it is ready.
  std::shared_ptr<Keyframe> take_step();

  void forget();

 private:
  void leave_out_objects();

  std::optional<std::size_t> rgbd_;
  KeyframeGrid grid_;
  KeyframeDepth depth_;
  Novelty novelty_;
  bool has_jumped_ = false;  ///< since the last frame
  // The camera's pose in the first frame and the last.
  std::optional<RigidTransform> first_from_world_, last_from_world_;
  double last_stamp_s_ = 0;  ///< of any frame
  double last_keyframe_s_ = 0;
  std::optional<RigidTransform> last_keyframe_from_world_;  ///< nothing: none was taken
  Rect last_objects_;                                       ///< in the last keyframe
  // Of the pending one.
  int steps_ = 0;  ///< that are left
  std::shared_ptr<Keyframe> keyframe_;
  Mask objects_;
  bool is_uncertain_ = false;
  std::vector<std::uint8_t> object_columns_;
};

}  // namespace diminish
