#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "composite/color_map.h"
#include "composite/map_colors.h"
#include "composite/soft_membrane.h"
#include "core/channels.h"
#include "core/even_color.h"
#include "core/rows.h"
#include "diminish/color_corrector.h"

namespace diminish {
namespace {

/// Where a channel is nearly black or white it no longer tells how much light there was.
bool is_exposed(const Eigen::Array3f& levels) {
  return (levels >= 6).all() && (levels <= 245).all();
}

/// Of each RGB-D camera: more make the map no better.
constexpr std::size_t most_pairs = 2000;

/// Maps each RGB-D camera's colours to the colour camera's by what both see anywhere in the
/// picture, in this frame. Unlike Poisson cloning it needs nothing to be right at the mask's rim,
/// where poses, depth edges and the object's own shadow do the most harm.
class MappedCorrection : public ColorCorrector {
 public:
  MappedCorrection(ColorMapModel model, bool with_membrane)
      : model_(model), with_membrane_(with_membrane) {}

  void correct(const Image<Bgr>& camera, const Mask& occlusion,
               const Reconstruction& reconstruction, Image<Bgr>& picture) override {
    fit_maps(camera, occlusion, reconstruction.samples);
    const Rect& region = reconstruction.region;
    membrane_.begin(region);
    if (with_membrane_) fit_membrane(camera, occlusion, reconstruction);
    for_rows(region.height, [&](Rows rows) {
      std::vector<float>& corrections = corrections_[rows.first == 0 ? 0 : 1];
      corrections.resize(3 * static_cast<std::size_t>(region.width));
      for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
        membrane_.row(y, corrections.data());
        map_colors(maps_, reconstruction, occlusion, y, corrections.data(), picture);
      }
    });
  }

 private:
  /// Samples come camera by camera.
  void fit_maps(const Image<Bgr>& camera, const Mask& occlusion,
                const std::vector<SceneSample>& samples) {
    std::fill(maps_.begin(), maps_.end(), ColorMap{});
    sources_.clear();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i == 0 || samples[i].source != samples[i - 1].source) sources_.push_back({i, i});
      sources_.back().end = i + 1;
    }
    if (pairs_.size() < sources_.size()) {
      pairs_.resize(sources_.size());
      fits_.resize(sources_.size());
    }
    oneapi::tbb::parallel_for(std::size_t{0}, sources_.size(), [&](std::size_t k) {
      const auto [begin, end] = sources_[k];
      pairs_[k].clear();
      const std::size_t step = (end - begin + most_pairs - 1) / most_pairs;
      for (std::size_t i = begin; i < end; i += step) {
        add_pair(camera, occlusion, samples[i], pairs_[k]);
      }
      maps_[samples[begin].source] = fits_[k].fit(pairs_[k], model_, camera.bounds());
    });
  }

  static void add_pair(const Image<Bgr>& camera, const Mask& occlusion, const SceneSample& sample,
                       std::vector<ColorPair>& pairs) {
    constexpr int rim = even_color_reach_px;
    const int x = static_cast<int>(std::lrint(sample.pixel.x()));
    const int y = static_cast<int>(std::lrint(sample.pixel.y()));
    if (!sample.even || x < rim || y < rim || x >= camera.width() - rim ||
        y >= camera.height() - rim) {
      return;
    }
    for (const int dy : {-rim, 0, rim}) {
      for (const int dx : {-rim, 0, rim}) {
        if (occlusion(x + dx, y + dy) != 0) return;
      }
    }
    const EvenColor color = even_color(camera, x, y);
    const ColorPair pair{sample.pixel,
                         to_channels(sample.color),
                         {color.channels[0], color.channels[1], color.channels[2]}};
    if (color.even && is_exposed(pair.rgbd) && is_exposed(pair.camera)) pairs.push_back(pair);
  }

  /// What is left after mapping where the reconstruction reaches beyond the mask.
  void fit_membrane(const Image<Bgr>& camera, const Mask& occlusion,
                    const Reconstruction& reconstruction) {
    const Rect& region = reconstruction.region;
    constexpr int step = SoftMembrane::step;
    for (int y = region.y; y < region.bottom(); y += step) {
      for (int x = region.x; x < region.right(); x += step) {
        const std::uint8_t source = reconstruction.source(x, y);
        if (occlusion(x, y) != 0 || source == 0) continue;
        const Bgra& color = reconstruction.color(x, y);
        const Eigen::Array3f mapped = maps_[source](to_channels({color.b, color.g, color.r}),
                                                    static_cast<float>(x), static_cast<float>(y));
        membrane_.add(x, y, to_channels(camera(x, y)) - mapped);
      }
    }
    membrane_.solve();
  }

  ColorMapModel model_;
  bool with_membrane_;
  /// Samples [begin, end) of one RGB-D camera.
  struct Source {
    std::size_t begin, end;
  };
  std::vector<Source> sources_;
  std::vector<std::vector<ColorPair>> pairs_;  ///< of each source
  std::vector<ColorMapFit> fits_;
  std::vector<ColorMap> maps_ = std::vector<ColorMap>(256);  ///< by Reconstruction::source
  SoftMembrane membrane_;
  std::vector<float> corrections_[2];  ///< of the row that each thread is at
};

template <ColorMapModel model, bool with_membrane>
std::unique_ptr<ColorCorrector> make() {
  return std::make_unique<MappedCorrection>(model, with_membrane);
}

const bool registered =
    Registry<ColorCorrector>::add("affine", make<ColorMapModel::affine, false>) &&
    Registry<ColorCorrector>::add("field", make<ColorMapModel::field, false>) &&
    Registry<ColorCorrector>::add("affine_membrane", make<ColorMapModel::affine, true>) &&
    Registry<ColorCorrector>::add("field_membrane", make<ColorMapModel::field, true>);

}  // namespace
}  // namespace diminish
