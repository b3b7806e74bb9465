#include <array>
#include <string>
#include <vector>

#include "composite/map_colors.h"
#include "core/channels.h"
#include "core/rows.h"
#include "core/runs.h"
#include "diminish/color_corrector.h"
#include "diminish/reconstructor.h"
#include "membrane/soft_membrane.h"

namespace diminish {
namespace {

/// ColorMaps, plus a soft membrane for what is left at the mask's rim.
class MappedCorrection : public ColorCorrector {
 public:
  struct Method {
    const char* name;
    ColorMapModel maps;
    bool with_membrane;
    const char* simpler;
  };
  explicit MappedCorrection(const Method& method) : method_(method) {}

  Declaration declaration() const override {
    using Rule = Declaration::Rule;
    return {method_.maps, method_.with_membrane ? Rule::maps_and_membrane : Rule::maps,
            method_.simpler};
  }

  void correct(const ColorInputs& inputs, Image<Bgr>& picture) override {
    const Rect& region = inputs.reconstruction.region;
    membrane_.begin(region);
    if (method_.with_membrane) fit_membrane(inputs);
    for_rows(region.height, [&](Rows rows) {
      std::vector<SoftMembrane::Node>& corrections = corrections_[rows.band];
      for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
        const std::uint8_t* const mask = inputs.occlusion.row(y);
        if (find_other(mask, region.x, region.right(), 0) == region.right()) continue;
        membrane_.row(y, corrections);
        map_colors(inputs.maps, inputs.reconstruction, inputs.occlusion, y, corrections.data(),
                   picture);
      }
    });
  }

 private:
  /// The difference after mapping, where the reconstruction reaches beyond the mask.
  void fit_membrane(const ColorInputs& inputs) {
    const auto& [camera, occlusion, reconstruction, maps] = inputs;
    const Rect& region = reconstruction.region;
    constexpr int step = SoftMembrane::step;
    static_assert(step % Reconstructor::sparse_step == 0, "other colours may be missing");
    membrane_.for_each_row([&, &camera = camera, &occlusion = occlusion,
                            &reconstruction = reconstruction, &maps = maps](int y) {
      for (int x = region.x; x < region.right(); x += step) {
        const std::uint8_t source = reconstruction.source(x, y);
        if (occlusion(x, y) != 0 || source == 0) continue;
        Eigen::Array3f mapped = map(maps[source], reconstruction.color(x, y), x, y);
        const SecondView& second = reconstruction.second;
        if (!second.share.empty() && second.share(x, y) != 0) {
          const Eigen::Array3f other = map(maps[second.source(x, y)], second.color(x, y), x, y);
          mapped += (other - mapped) * (static_cast<float>(second.share(x, y)) / 255);
        }
        membrane_.add(x, y, to_channels(camera(x, y)) - mapped);
      }
    });
    membrane_.solve();
  }

  static Eigen::Array3f map(const ColorMap& map, const Bgra& color, int x, int y) {
    return map(to_channels({color.b, color.g, color.r}), static_cast<float>(x),
               static_cast<float>(y));
  }

  Method method_;
  SoftMembrane membrane_;
  std::vector<SoftMembrane::Node> corrections_[most_bands];  ///< of a row of each band
};

constexpr std::array<MappedCorrection::Method, 4> methods{{
    {"affine", ColorMapModel::affine, false, nullptr},
    {"field", ColorMapModel::field, false, "affine"},
    {"affine_membrane", ColorMapModel::affine, true, "affine"},
    {"field_membrane", ColorMapModel::field, true, "affine"},
}};
const bool mapped_correction_registered = [] {
  for (const MappedCorrection::Method& method : methods) {
    Registry<ColorCorrector>::add(method.name,
                                  [&method] { return std::make_unique<MappedCorrection>(method); });
  }
  return true;
}();

}  // namespace
}  // namespace diminish
