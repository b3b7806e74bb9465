#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/scene_samples.h"
#include "scene/color_map.h"

namespace diminish {

/// Maps each RGB-D camera's colours to the colour camera's, from what both see anywhere in the
/// picture of this frame. Unlike Poisson cloning it does not depend on the mask's rim, where errors
/// in poses and depth edges and the object's own shadow do the most harm.
class ColorMaps {
 public:
  /// samples: sorted by camera. occlusion: where `camera` shows an object to remove; not used
  /// there. Cameras without samples keep their colours; with the model `none`, all do. Cost: 0.1 us
  /// per sample.
  void fit(ImageView<Bgr> camera, const Mask& occlusion, const std::vector<SceneSample>& samples,
           ColorMapModel model);
  /// By Reconstruction::source.
  ColorMapsBySource by_source() const { return maps_; }

 private:
  /// Samples [begin, end) of one RGB-D camera.
  struct Source {
    std::size_t begin, end;
  };
  static constexpr std::size_t parts = 4;
  struct Pairs {
    std::array<std::vector<ColorPair>, parts> of_part;
    std::vector<ColorPair> all;
  };

  void find_pairs(ImageView<Bgr> camera, const Mask& occlusion,
                  std::span<const SceneSample> samples, std::size_t k);

  std::vector<Source> sources_;
  std::vector<Pairs> pairs_;       ///< of each source
  std::vector<ColorMapFit> fits_;  ///< likewise
  std::vector<ColorMap> maps_ = std::vector<ColorMap>(256);
};

}  // namespace diminish
