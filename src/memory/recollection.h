#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "diminish/reconstructor.h"
#include "memory/keyframe_store.h"
#include "memory/recall_inputs.h"
#include "memory/torn_edges.h"
#include "memory/witness.h"
#include "pose/pose_refinement.h"
#include "scene/color_maps.h"

namespace diminish {

/// Draws a keyframe as an RGB-D camera's images, from the viewpoint of another frame.
class Recollection {
 public:
  Recollection(const Rig& rig, const KeyframeGrid& grid);

  /// Begins with a keyframe, where the frame's pose says.
  void begin(const KeyframeStore::Choice& choice, const RecallInputs& inputs);
  /// Moves the keyframe so that it about matches the frame's picture. Returns how: for the user's
  /// own mostly the error of the frame's pose, so that other keyframes are moved likewise before.
  /// Nothing if that is not known.
  std::optional<RigidTransform> align(const RecallInputs& inputs);
  void move(const std::optional<RigidTransform>& motion);
  /// Aligns it further (the same camera: to a tenth of a pixel), finds its gain, and what has
  /// changed since. now: this frame's testimonies.
  void prepare(const RecallInputs& inputs, const std::vector<Testimony>& now);
  /// Draws what has not changed.
  void draw(const RecallInputs& inputs);

  const Reconstruction& drawn() const { return drawn_; }
  /// That is drawn.
  const TiledRegion& part() const { return part_; }
  /// What the keyframe shows beside the objects: pixels of this frame, near those that it is to
  /// show; anywhere around if there are fewer than that.
  static constexpr std::size_t fewest_beside = 50;
  struct Beside {
    int x, y;
    Bgr color;  ///< the keyframe's
  };
  const std::vector<Beside>& beside() const { return beside_; }
  const Keyframe& keyframe() const { return *keyframe_; }
  /// What the keyframe's camera saw, where it is in the frame's picture.
  const SceneSamples& samples() const { return samples_; }
  /// One of the keyframe's colours as it is in the frame.
  Eigen::Array3f mapped(std::uint8_t b, std::uint8_t g, std::uint8_t r) const {
    return {levels_[0][b], levels_[1][g], levels_[2][r]};
  }
  const Witness& witness() const { return witness_; }
  /// How far the user's camera has moved since.
  double baseline_m() const { return poses_.color_from_depth[0]->translation.norm(); }
  /// Witness::judge.
  const std::vector<Eigen::Vector3f>& gone() const { return gone_; }

 private:
  void find_levels(const ColorMap& map);
  void find_beside(const RecallInputs& inputs);
  /// Adds those of some of the grid's places, of every so many rows, in a part of the picture.
  void add_beside(const RecallInputs& inputs, const Rect& places, int rows_apart, const Rect& part);

  Rig rig_;  ///< the user's camera, and the keyframe
  KeyframeGrid grid_;
  Projection color_;
  PoseRefinement far_, coarse_, fine_;
  ColorMaps color_maps_;
  Witness witness_;
  std::unique_ptr<Reconstructor> drawer_;
  std::shared_ptr<const Keyframe> keyframe_;  ///< `frame_` shows its picture
  FrameSet frame_;
  DepthImages depth_;
  Poses poses_;
  OcclusionMasks masks_;  ///< all clear: the keyframe's depth has no objects
  SceneSamples samples_;
  std::vector<SceneSample> some_;
  std::vector<Eigen::Vector3f> gone_;
  TiledRegion part_;
  std::array<std::array<float, 256>, 3> levels_;  ///< of each channel, mapped to the frame's
  std::vector<Beside> beside_;
  Reconstruction drawn_;
  TornEdges edges_;
};

}  // namespace diminish
