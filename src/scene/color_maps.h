#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "diminish/image.h"
#include "diminish/reconstruction.h"
#include "scene/color_map.h"

namespace diminish {

/// A colour correction that maps colours, by its registered name.
struct MappedMethod {
  std::string_view name;
  ColorMapModel model;
  bool with_membrane;  ///< adds a SoftMembrane for what is left at the mask's rim
};
inline constexpr std::array<MappedMethod, 4> mapped_methods{{
    {"affine", ColorMapModel::affine, false},
    {"field", ColorMapModel::field, false},
    {"affine_membrane", ColorMapModel::affine, true},
    {"field_membrane", ColorMapModel::field, true},
}};
/// Null if the name is another correction's.
const MappedMethod* find_mapped_method(std::string_view name);

/// Maps each RGB-D camera's colours to the colour camera's, from what both see anywhere in the
/// picture of this frame. Unlike Poisson cloning it does not depend on the mask's rim, where errors
/// in poses and depth edges and the object's own shadow do the most harm.
class ColorMaps {
 public:
  /// samples: sorted by camera. occlusion: where `camera` shows an object to remove; not used
  /// there. Cameras without samples keep their colours. Cost: 0.1 us per sample.
  void fit(const Image<Bgr>& camera, const Mask& occlusion, const std::vector<SceneSample>& samples,
           ColorMapModel model);
  /// Cameras keep their colours.
  void clear();

  /// Indexed by Reconstruction::source.
  const std::vector<ColorMap>& by_source() const { return maps_; }

 private:
  /// Samples [begin, end) of one RGB-D camera.
  struct Source {
    std::size_t begin, end;
  };
  std::vector<Source> sources_;
  std::vector<std::vector<ColorPair>> pairs_;  ///< of each source
  std::vector<ColorMapFit> fits_;              ///< likewise
  std::vector<ColorMap> maps_ = std::vector<ColorMap>(256);
};

}  // namespace diminish
