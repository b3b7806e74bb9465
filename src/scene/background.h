#pragma once

#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "diminish/scene_samples.h"
#include "diminish/surfaces.h"
#include "scene/background_planes.h"
#include "scene/cast_shadows.h"
#include "scene/thing_light.h"

namespace diminish {

/// The planes behind the objects to remove, and the shadows that the objects cast on them.
class Background {
 public:
  explicit Background(const Intrinsics& color) : planes_(color), shadows_(color) {}

  struct Wanted {
    bool planes, shadows;  ///< shadows only with planes
    bool things;           ///< also shadows on what stands in front of the planes
  };
  /// Finds the planes and shadows. objects: their box in the colour camera's picture.
  void find(const Rect& objects, const SceneSamples& samples, const Wanted& wanted);
  /// Nothing was looked for.
  void clear() {
    has_planes_ = false;
    shadows_.clear();
  }
  /// Null if they were not looked for.
  const std::vector<BackgroundPlane>* planes() const {
    return has_planes_ ? &planes_.planes() : nullptr;
  }
  std::span<const CastShadow> shadows() const { return shadows_.shadows(); }
  /// The shadows' place in the colour camera's picture.
  Rect shaded_part() const { return shadows_.bounds(); }

  /// Fills in which plane each pixel of the drawn scene shows, and how much light the shadows leave
  /// on it.
  void label(const Reconstruction& reconstruction, Surfaces& surfaces);

 private:
  BackgroundPlanes planes_;
  CastShadows shadows_;
  ThingLight thing_light_;
  bool has_things_ = false;
  bool has_planes_ = false;
};

}  // namespace diminish
