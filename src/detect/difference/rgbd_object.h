#pragma once

#include <vector>

#include "detect/difference/object_evidence.h"
#include "detect/difference/seen_layers.h"
#include "diminish/image.h"

namespace diminish {

/// Finds an object that the colour camera shows in an RGB-D camera's images: the surface that the
/// colour camera sees, and what is joined to it inside the object's outline.
class RgbdObject {
 public:
  struct Inputs {
    const Mask& regions;        ///< of the small picture: where it shows an object
    const Image<Shown>& shown;  ///< the evidence, before what is unknown was filled in
    const SeenLayers& layers;
    const ObjectEvidence& evidence;
    const std::vector<BackgroundPlane>& planes;
    sdct::Threshold threshold;
  };
  /// vertices: the RGB-D camera's. step: between its depth pixels that are used. Adds to its masks.
  /// Returns whether there is something to add.
  bool add(const Inputs& inputs, const Image<LayerVertex>& vertices, int step, Mask& depth_mask,
           Mask& color_mask);

 private:
  std::vector<Eigen::Vector2i> open_ends_;
  Mask visited_;
};

}  // namespace diminish
