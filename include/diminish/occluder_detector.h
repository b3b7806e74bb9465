#pragma once

#include <functional>
#include <memory>

#include "diminish/error.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/registry.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// The input of a detector: this frame and what is known of it so far.
struct Observation {
  const FrameSet& frame;
  const Markers& markers;
  const Poses& poses;
  const Options& options;
};

/// Finds one object to remove. Registered by name; chosen by `detector` in scene.yaml.
class DIMINISH_EXPORT OccluderDetector {
 public:
  static constexpr const char* kind = "detector";
  struct Entry {
    /// Reads the detector's settings from its object's place in scene.yaml, which also has the keys
    /// `name` and `detector`. Throws Error that names file and key. Need not check what the
    /// settings themselves check.
    std::function<std::shared_ptr<const OccluderSettings>(const Config& place)> read;
    /// Creates the detector. Throws Error on settings that cannot work.
    std::function<std::unique_ptr<OccluderDetector>(const OccluderSpec& spec, const Rig& rig)> make;
  };
  using Factory = Entry;

  virtual ~OccluderDetector() = default;

  /// Whether `Observation::markers` must be filled.
  virtual bool needs_markers() const { return false; }

  /// Whether it keeps something from frame to frame. It then gets the frames of a sequence in their
  /// order, also where several pipelines share the frames.
  virtual bool needs_order() const { return false; }
  /// If it needs order: takes over what `other`, which finds the same object in other frames of the
  /// same sequence, keeps from frame to frame. Only one of them is called at a time.
  virtual void share(OccluderDetector& other) { static_cast<void>(other); }

  /// Sets the object's pixels in `masks` to 255 and leaves the others alone. `masks` has the rig's
  /// sizes. Leaves cameras without images in this frame alone too.
  virtual OccluderReport detect(const Observation& observation, OcclusionMasks& masks) = 0;
  /// The same. report: an earlier frame's, whose memory may be used again.
  virtual void detect_again(const Observation& observation, OcclusionMasks& masks,
                            OccluderReport& report) {
    report = detect(observation, masks);
  }
};

/// The object's settings, as its detector's own type. Throws Error if they have another type.
template <class Settings>
const Settings& settings_of(const OccluderSpec& spec) {
  const auto* const settings = dynamic_cast<const Settings*>(spec.settings.get());
  if (settings != nullptr) return *settings;
  throw Error(spec.name + ": expected the settings of the detector " + spec.detector);
}

}  // namespace diminish
