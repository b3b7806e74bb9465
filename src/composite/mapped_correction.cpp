#include <vector>

#include "composite/map_colors.h"
#include "core/channels.h"
#include "core/rows.h"
#include "diminish/color_corrector.h"
#include "membrane/soft_membrane.h"
#include "scene/color_maps.h"

namespace diminish {
namespace {

/// ColorMaps, plus a soft membrane for what is left.
class MappedCorrection : public ColorCorrector {
 public:
  explicit MappedCorrection(const MappedMethod& method) : method_(method) {}

  void prepare(const Image<Bgr>& camera, const Mask& occlusion,
               const std::vector<SceneSample>& samples) override {
    maps_.fit(camera, occlusion, samples, method_.model);
  }

  void correct(const Image<Bgr>& camera, const Mask& occlusion,
               const Reconstruction& reconstruction, Image<Bgr>& picture) override {
    const Rect& region = reconstruction.region;
    membrane_.begin(region);
    if (method_.with_membrane) fit_membrane(camera, occlusion, reconstruction);
    for_rows(region.height, [&](Rows rows) {
      std::vector<float>& corrections = corrections_[rows.first == 0 ? 0 : 1];
      corrections.resize(3 * static_cast<std::size_t>(region.width));
      for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
        const Rect wanted = bounding_box(occlusion, {region.x, y, region.width, 1});
        if (wanted.empty()) continue;
        membrane_.row(y, wanted.x - region.x, wanted.right() - region.x, corrections.data());
        map_colors(maps_.by_source(), reconstruction, occlusion, y, corrections.data(), picture);
      }
    });
  }

 private:
  /// The difference after mapping, where the reconstruction reaches beyond the mask.
  void fit_membrane(const Image<Bgr>& camera, const Mask& occlusion,
                    const Reconstruction& reconstruction) {
    const Rect& region = reconstruction.region;
    constexpr int step = SoftMembrane::step;
    for (int y = region.y; y < region.bottom(); y += step) {
      for (int x = region.x; x < region.right(); x += step) {
        const std::uint8_t source = reconstruction.source(x, y);
        if (occlusion(x, y) != 0 || source == 0) continue;
        Eigen::Array3f mapped = map(source, reconstruction.color(x, y), x, y);
        const SecondView& second = reconstruction.second;
        if (!second.share.empty() && second.share(x, y) != 0) {
          const Eigen::Array3f other = map(second.source(x, y), second.color(x, y), x, y);
          mapped += (other - mapped) * (static_cast<float>(second.share(x, y)) / 255);
        }
        membrane_.add(x, y, to_channels(camera(x, y)) - mapped);
      }
    }
    membrane_.solve();
  }

  Eigen::Array3f map(std::uint8_t source, const Bgra& color, int x, int y) const {
    return maps_.by_source()[source](to_channels({color.b, color.g, color.r}),
                                     static_cast<float>(x), static_cast<float>(y));
  }

  MappedMethod method_;
  ColorMaps maps_;
  SoftMembrane membrane_;
  std::vector<float> corrections_[2];  ///< of each thread's current row
};

const bool registered = [] {
  for (const MappedMethod& method : mapped_methods) {
    Registry<ColorCorrector>::add(std::string(method.name),
                                  [&method] { return std::make_unique<MappedCorrection>(method); });
  }
  return true;
}();

}  // namespace
}  // namespace diminish
