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

/// What a detector may look at: this frame, and what is known of it so far.
struct Observation {
  const FrameSet& frame;
  const Markers& markers;
  const Poses& poses;
  const Options& options;
};

/// Finds one object to remove. Registered by name; `detector` in scene.yaml chooses.
class DIMINISH_EXPORT OccluderDetector {
 public:
  static constexpr const char* kind = "detector";
  struct Entry {
    /// Reads the detector's settings from its object's place in scene.yaml, which also has the keys
    /// `name` and `detector`. Throws Error, naming file and key. What the settings themselves
    /// check, it need not.
    std::function<std::shared_ptr<const OccluderSettings>(const Config& place)> read;
    /// Makes the detector. Throws Error on settings that cannot work.
    std::function<std::unique_ptr<OccluderDetector>(const OccluderSpec& spec, const Rig& rig)> make;
  };
  using Factory = Entry;

  virtual ~OccluderDetector() = default;

  /// Whether the observation must hold the markers of the colour images.
  virtual bool needs_markers() const { return false; }

  /// Sets the object's pixels in `masks` to 255 and leaves the others alone. `masks` has the rig's
  /// sizes. Cameras without images in this frame are left alone too.
  virtual OccluderReport detect(const Observation& observation, OcclusionMasks& masks) = 0;
};

/// The object's settings as its detector's own type. Throws Error if they are of another.
template <class Settings>
const Settings& settings_of(const OccluderSpec& spec) {
  const auto* const settings = dynamic_cast<const Settings*>(spec.settings.get());
  if (settings != nullptr) return *settings;
  throw Error(spec.name + ": expected the settings of the detector " + spec.detector);
}

}  // namespace diminish
