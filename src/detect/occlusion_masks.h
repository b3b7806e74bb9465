#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/backoff.h"
#include "core/turns.h"
#include "detect/shape_detector.h"
#include "detect/silhouette/mask_drawer.h"
#include "diminish/occluder_detector.h"

namespace diminish {

/// Finds all of a scene's objects to remove. With the option `memory`, one that nobody sees for a
/// moment is continued by its motion; some detectors keep something themselves. Several stages then
/// share what they know, and each, with a frame of the same sequence, takes its turn.
class OccluderStage {
 public:
  /// Throws Error on unknown detectors and wrong settings.
  OccluderStage(const Rig& rig, const Scene& scene);

  /// Whether the observation must hold the markers of the colour images.
  bool needs_markers() const;

  /// drawer: a registered MaskDrawer's name; "cpu" at first. If it fails, the CPU draws; the
  /// next frame tries again, then ever later ones.
  void draw_by(const std::string& drawer);

  /// Of the same scene.
  void share(OccluderStage& other);
  void take_turn() { turn_.take(shared_->turns); }
  /// Does nothing if there is none.
  void end_turn() { turn_.end(); }

  /// Waits for its turn, if what it knows of other frames matters. Ends it. Replaces the masks by
  /// the union of all objects' masks in this frame, grown by the options' margins, and `reports` by
  /// one report for each object. Objects in the option `keep` are not looked for.
  void detect(const Observation& observation, std::vector<OccluderReport>& reports);

  /// The shapes of the objects, where they are known: vertices in the colour camera's frame, by
  /// object.
  std::span<const std::vector<Eigen::Vector3d>> vertices_m() const { return outlines_.vertices_m; }
  /// Adds pixels to the colour camera's mask of this frame.
  void add(std::span<const Eigen::Vector2i> pixels);

  const OcclusionMasks& masks() const { return masks_; }
  /// The colour camera's mask's bounding box.
  const Rect& objects() const { return objects_; }
  /// Why the last frame's masks were not drawn as chosen; empty if they were.
  const std::string& message() const { return message_; }

 private:
  struct Shared {
    Turns turns;
    std::vector<ObjectTrack> tracks;
  };

  void clear();
  void draw(const Options& options, std::vector<OccluderReport>& reports);
  void list_drawings(const Options& options);
  void draw_by_chosen();
  /// False if the chosen drawer fails.
  bool try_drawer();

  Rig rig_;
  std::vector<std::unique_ptr<OccluderDetector>> detectors_;
  std::vector<std::string> names_;  ///< of the objects
  bool needs_order_ = false;        ///< does one of the detectors?
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  Turn turn_;
  OcclusionOutlines outlines_;
  bool is_blank_ = true;               ///< no detector has set pixels in this frame yet
  std::vector<MaskDrawing> drawings_;  ///< color, and of each RGB-D camera color and depth
  OcclusionMasks masks_;
  std::vector<Rect> parts_;  ///< in the order of drawings: outside of which masks are 0
  Rect objects_;
  std::string drawer_name_ = "cpu";
  std::unique_ptr<MaskDrawer> drawer_, cpu_;
  Backoff attempts_;
  std::string failure_;  ///< the drawer's last one
  std::string message_;
};

}  // namespace diminish
