#include "scene/scene_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/robust.h"
#include "core/shrunk_picture.h"
#include "core/tasks.h"

namespace diminish {
namespace {

/// A sample's colour is that of about so many columns' width.
constexpr int usual_columns = 320;
constexpr int tiles_across = 16;
constexpr double fewest_samples = 10;
constexpr std::size_t fewest_tiles = 8;
/// Of the brightness in a tile: below this noise decides.
constexpr double least_deviation = 8;
/// Samples so much farther away than the nearest in their cell are hidden by it.
constexpr float hidden_share = 0.15F;
constexpr int cells_in_tile = 2;
constexpr float nothing_near_m = std::numeric_limits<float>::max();

/// Samples outside the picture may be far outside, or nowhere.
bool is_inside(ImageView<Bgr> picture, const Eigen::Vector2f& pixel) {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < static_cast<float>(picture.width()) &&
         pixel.y() < static_cast<float>(picture.height());
}

}  // namespace

SceneFit::SceneFit(const Intrinsics& color)
    : block_(std::max(1, color.width / usual_columns)),
      tile_side_(std::max(1, color.width / tiles_across)),
      columns_(color.width / tile_side_ + 2),
      rows_(color.height / tile_side_ + 2),
      cell_side_(std::max(1, tile_side_ / cells_in_tile)),
      nearest_m_(color.width / cell_side_ + 1, color.height / cell_side_ + 1) {
  for (Tiles& tiles : tiles_) {
    tiles.resize(2 * static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  }
}

void SceneFit::find(ImageView<Bgr> picture, const Mask& occlusion, const SceneSamples& scene,
                    std::vector<std::optional<double>>& by_camera) {
  find_nearest(picture, scene);
  auto begin = scene.surfaces.begin();
  for (std::size_t k = 0; k < by_camera.size(); ++k) {
    const auto end = std::find_if(begin, scene.surfaces.end(),
                                  [&](const SceneSample& sample) { return sample.source > k + 1; });
    by_camera[k] = correlate(picture, occlusion, begin, end);
    begin = end;
  }
}

void SceneFit::find_nearest(ImageView<Bgr> picture, const SceneSamples& scene) {
  nearest_m_.fill(nothing_near_m);
  for (const SceneSample& sample : scene.surfaces) {
    if (!is_inside(picture, sample.pixel)) continue;
    float& nearest_m = nearest_m_(cell_of(sample.pixel.x()), cell_of(sample.pixel.y()));
    nearest_m = std::min(nearest_m, sample.point_m.z());
  }
}

std::optional<double> SceneFit::correlate(ImageView<Bgr> picture, const Mask& occlusion,
                                          Samples begin, Samples end) {
  const auto count = static_cast<std::size_t>(end - begin);
  for_tasks(bands, [&](std::size_t band) {
    const auto at = [&](std::size_t i) {
      return begin + static_cast<std::ptrdiff_t>(i * count / bands);
    };
    add_up(picture, occlusion, at(band), at(band + 1), tiles_[band]);
  });
  found_.clear();
  for (std::size_t tile = 0; tile < tiles_[0].size(); ++tile) collect(tile);
  if (found_.size() < fewest_tiles) return std::nullopt;
  // The tiles with more texture than most: they show a shift best.
  values_.clear();
  for (const Textured& tile : found_) values_.push_back(tile.deviation);
  const double least = std::max(least_deviation, median(values_));
  values_.clear();
  for (const Textured& tile : found_) {
    if (tile.deviation >= least) values_.push_back(tile.correlation);
  }
  if (values_.size() < fewest_tiles) return std::nullopt;
  return median(values_);
}

void SceneFit::add_up(ImageView<Bgr> picture, const Mask& occlusion, Samples begin, Samples end,
                      Tiles& tiles) const {
  std::fill(tiles.begin(), tiles.end(), Tile{});
  for (auto sample = begin; sample != end; ++sample) {
    const auto shown = brightness_at(picture, occlusion, sample->pixel);
    if (!shown || sample->point_m.z() > (1 + hidden_share) * nearest_m_(cell_of(sample->pixel.x()),
                                                                        cell_of(sample->pixel.y())))
      continue;
    const double a = *shown;
    const double b = brightness(sample->color.b, sample->color.g, sample->color.r);
    const int x = static_cast<int>(sample->pixel.x());
    const int y = static_cast<int>(sample->pixel.y());
    for (const int grid : {0, 1}) {
      const int shift = grid * tile_side_ / 2;
      const int row = (y + shift) / tile_side_ + grid * rows_;
      Tile& tile = tiles[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>((x + shift) / tile_side_)];
      tile.count += 1;
      tile.a += a;
      tile.b += b;
      tile.aa += a * a;
      tile.bb += b * b;
      tile.ab += a * b;
    }
  }
}

void SceneFit::collect(std::size_t index) {
  Tile tile;
  for (const Tiles& tiles : tiles_) {
    const Tile& part = tiles[index];
    tile.count += part.count;
    tile.a += part.a;
    tile.b += part.b;
    tile.aa += part.aa;
    tile.bb += part.bb;
    tile.ab += part.ab;
  }
  if (tile.count < fewest_samples) return;
  const double aa = std::max(0., tile.aa - tile.a * tile.a / tile.count);
  const double bb = std::max(0., tile.bb - tile.b * tile.b / tile.count);
  const double ab = tile.ab - tile.a * tile.b / tile.count;
  constexpr double nothing = 1e-3;  // a tile of a single colour correlates with nothing
  found_.push_back({ab / std::sqrt(aa * bb + nothing), std::sqrt(aa / tile.count)});
}

std::optional<float> SceneFit::brightness_at(ImageView<Bgr> picture, const Mask& occlusion,
                                             const Eigen::Vector2f& pixel) const {
  if (!is_inside(picture, pixel)) return std::nullopt;
  const int left = static_cast<int>(std::lrint(pixel.x())) - block_ / 2;
  const int top = static_cast<int>(std::lrint(pixel.y())) - block_ / 2;
  if (left < 0 || top < 0 || left + block_ > picture.width() || top + block_ > picture.height() ||
      occlusion.row(top + block_ / 2)[left + block_ / 2] != 0) {
    return std::nullopt;
  }
  int blue = 0;
  int green = 0;
  int red = 0;
  for (int y = top; y < top + block_; ++y) {
    const Bgr* const row = picture.row(y);
    for (int x = left; x < left + block_; ++x) {
      blue += row[x].b;
      green += row[x].g;
      red += row[x].r;
    }
  }
  return brightness(blue, green, red) / static_cast<float>(block_ * block_);
}

}  // namespace diminish
