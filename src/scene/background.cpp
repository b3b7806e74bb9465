#include "scene/background.h"

namespace diminish {

void Background::find(const Rect& objects, const SceneSamples& samples, const Wanted& wanted) {
  has_planes_ = wanted.planes;
  has_things_ = wanted.things;
  shadows_.clear();
  if (!wanted.planes) return;
  planes_.find(objects, samples.surfaces);
  if (wanted.shadows) {
    shadows_.find(planes_.planes(), samples.surfaces, samples.object_points_m);
  }
}

void Background::label(const Reconstruction& reconstruction, Surfaces& surfaces) {
  if (has_planes_) {
    planes_.label(reconstruction, surfaces);
  } else {
    surfaces.region = static_cast<const Rect&>(reconstruction.region);
    surfaces.label.resize(0, 0);
  }
  if (shadows_.any()) {
    shadows_.shade(reconstruction, surfaces);
    if (has_things_) {
      thing_light_.shade(shadows_.shadows(), shadows_.rays(), reconstruction.depth_m, surfaces);
    }
  } else {
    surfaces.light.resize(0, 0);
  }
}

}  // namespace diminish
