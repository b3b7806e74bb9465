#include "scene/color_maps.h"

#include <algorithm>
#include <cmath>

#include "core/channels.h"
#include "core/even_color.h"
#include "core/tasks.h"

namespace diminish {
namespace {

/// A channel that is nearly black or white does not say how much light there was.
bool is_exposed(const Eigen::Array3f& levels) {
  return (levels >= 6).all() && (levels <= 245).all();
}

/// Pairs of each RGB-D camera: more do not improve the map.
constexpr std::size_t most_pairs = 2000;

/// Returns whether the sample makes a pair.
bool find_pair(ImageView<Bgr> camera, const Mask& occlusion, const SceneSample& sample,
               ColorPair& pair) {
  constexpr int rim = even_color_reach_px;
  const int x = static_cast<int>(std::lrint(sample.pixel.x()));
  const int y = static_cast<int>(std::lrint(sample.pixel.y()));
  if (!sample.even || x < rim || y < rim || x >= camera.width() - rim ||
      y >= camera.height() - rim) {
    return false;
  }
  for (const int dy : {-rim, 0, rim}) {
    for (const int dx : {-rim, 0, rim}) {
      if (occlusion(x + dx, y + dy) != 0) return false;
    }
  }
  const EvenColor color = even_color(camera, x, y);
  pair = {sample.pixel,
          to_channels(sample.color),
          {color.channels[0], color.channels[1], color.channels[2]}};
  return color.even && is_exposed(pair.rgbd) && is_exposed(pair.camera);
}

}  // namespace

void ColorMaps::fit(ImageView<Bgr> camera, const Mask& occlusion,
                    const std::vector<SceneSample>& samples, ColorMapModel model) {
  std::fill(maps_.begin(), maps_.end(), ColorMap{});
  if (model == ColorMapModel::none) return;
  sources_.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i == 0 || samples[i].source != samples[i - 1].source) sources_.push_back({i, i});
    sources_.back().end = i + 1;
  }
  if (pairs_.size() < sources_.size()) {
    pairs_.resize(sources_.size());
    fits_.resize(sources_.size());
  }
  for_tasks(sources_.size(), [&](std::size_t k) {
    const auto [begin, end] = sources_[k];
    find_pairs(camera, occlusion, std::span(samples).subspan(begin, end - begin), k);
    maps_[samples[begin].source] = fits_[k].fit(pairs_[k].all, model, camera.bounds());
  });
}

/// In parts, which follow one another in the end.
void ColorMaps::find_pairs(ImageView<Bgr> camera, const Mask& occlusion,
                           std::span<const SceneSample> samples, std::size_t k) {
  const std::size_t step = (samples.size() + most_pairs - 1) / most_pairs;
  for_tasks(parts, [&](std::size_t part) {
    std::vector<ColorPair>& pairs = pairs_[k].of_part[part];
    pairs.clear();
    const std::size_t count = (samples.size() + step - 1) / step;
    for (std::size_t i = part * count / parts; i < (part + 1) * count / parts; ++i) {
      ColorPair pair{};
      if (find_pair(camera, occlusion, samples[i * step], pair)) pairs.push_back(pair);
    }
  });
  std::vector<ColorPair>& all = pairs_[k].all;
  all.clear();
  for (const auto& pairs : pairs_[k].of_part) all.insert(all.end(), pairs.begin(), pairs.end());
}

}  // namespace diminish
