#include "memory/recall_merge.h"

#include <algorithm>
#include <cmath>

#include "core/channels.h"
#include "core/rows.h"
#include "memory/light.h"

namespace diminish {
namespace {

Eigen::Array3f mapped(const ColorMap& map, const Bgra& color, int x, int y) {
  return map(to_channels({color.b, color.g, color.r}), static_cast<float>(x),
             static_cast<float>(y));
}

}  // namespace

RecallMerge::RecallMerge(const Intrinsics& color) : color_(color) {}

bool RecallMerge::explains_surroundings(const RecallInputs& inputs,
                                        const Recollection& recollection,
                                        const Reconstruction& live) const {
  constexpr int stride = 3;
  constexpr float most = 60;  // levels: more is no worse
  constexpr int fewest = 50;
  constexpr float slack = 4;    // levels
  constexpr float enough = 12;  // levels, where the cameras see too little to compare with
  float error = 0;
  float shared_error = 0;
  float live_error = 0;
  int count = 0;
  int shared = 0;
  const Reconstruction& drawn = recollection.drawn();
  for (int y = region_.y; y < region_.bottom(); y += stride) {
    for (int x = region_.x; x < region_.right(); x += stride) {
      if (inputs.masks.color(x, y) != 0 || !inputs.region.keeps(x, y)) continue;
      if (drawn.source(x, y) == 0) continue;
      const Eigen::Array3f seen = to_channels(inputs.frame.color(x, y));
      // The objects' shadows are in one of the two only.
      const auto difference = [&](const Eigen::Array3f& color) {
        return std::min(most, (light_between(seen, color, 1) * color - seen).abs().mean());
      };
      const float own = difference(mapped(recollection.color_map(), drawn.color(x, y), x, y));
      error += own;
      ++count;
      const std::uint8_t source = live.source(x, y);
      if (source == 0) continue;
      live_error += difference(mapped(inputs.color_maps[source], live.color(x, y), x, y));
      shared_error += own;
      ++shared;
    }
  }
  if (shared >= fewest) {
    const auto n = static_cast<float>(shared);
    return shared_error / n <= live_error / n + slack;
  }
  return count >= fewest && error / static_cast<float>(count) <= enough;
}

void RecallMerge::layer_rows(std::span<const Recollection> recollections, Rows rows) {
  for (int y = rows.first; y < rows.last; ++y) {
    std::uint8_t* const layer = layer_.row(y);
    float* const depth_m = depth_m_.row(y);
    std::fill_n(layer, region_.width, std::uint8_t{0});
    std::fill_n(depth_m, region_.width, 0.F);
    for (std::size_t i = 0; i < recollections.size(); ++i) {
      if (usable_[i] == 0) continue;
      const Reconstruction& drawn = recollections[i].drawn();
      const std::uint8_t* const source = drawn.source.row(y + region_.y) + region_.x;
      const float* const drawn_m = drawn.depth_m.row(y + region_.y) + region_.x;
      for (int x = 0; x < region_.width; ++x) {
        const bool is_next = layer[x] == 0 && source[x] != 0;
        layer[x] = is_next ? static_cast<std::uint8_t>(1 + i) : layer[x];
        depth_m[x] = is_next ? drawn_m[x] : depth_m[x];
      }
    }
  }
}

bool RecallMerge::is_nearer(float z_m, int x, int y, float tolerance_m) const {
  constexpr int reach = 5;  // edges of the cameras' surfaces are off by some pixels
  const Rect around = intersect(grow({x, y, 1, 1}, reach), layer_.bounds());
  for (int row = around.y; row < around.bottom(); ++row) {
    for (int column = around.x; column < around.right(); ++column) {
      if (layer_(column, row) != 0 && !(z_m < depth_m_(column, row) - tolerance_m)) return false;
    }
  }
  return true;
}

Bgr RecallMerge::mean_color(std::span<const Recollection> recollections, int x, int y) const {
  constexpr float other_surface = 60;  // levels
  const int column = x + region_.x;
  const int row = y + region_.y;
  const auto color_of = [&](const Recollection& recollection) {
    return mapped(recollection.color_map(), recollection.drawn().color(column, row), column, row);
  };
  const std::size_t best = layer_(x, y) - 1U;
  const Eigen::Array3f best_color = color_of(recollections[best]);
  const float tolerance_m = between_cameras.at(depth_m_(x, y));
  Eigen::Array3f sum = best_color;
  int count = 1;
  for (std::size_t i = best + 1; i < recollections.size(); ++i) {
    const Reconstruction& drawn = recollections[i].drawn();
    if (usable_[i] == 0 || drawn.source(column, row) == 0 ||
        std::abs(drawn.depth_m(column, row) - depth_m_(x, y)) > tolerance_m) {
      continue;
    }
    const Eigen::Array3f color = color_of(recollections[i]);
    if ((color - best_color).abs().maxCoeff() > other_surface) continue;
    sum += color;
    ++count;
  }
  return to_color(sum / static_cast<float>(count));
}

void RecallMerge::merge_row(const RecallInputs& inputs, std::span<const Recollection> recollections,
                            bool witnessed_only, int y, Reconstruction& reconstruction) const {
  const int row = y + region_.y;
  for (int x = 0; x < region_.width; ++x) {
    const int column = x + region_.x;
    if (layer_(x, y) == 0 || inputs.masks.color(column, row) == 0) continue;
    const Recollection& recollection = recollections[layer_(x, y) - 1U];
    const float z_m = depth_m_(x, y);
    const std::uint8_t source = reconstruction.source(column, row);
    bool is_witnessed = false;
    if (source != 0) {
      const std::size_t k = source - 1U;
      const float live_m = reconstruction.depth_m(column, row);
      const Eigen::Vector2f ray = (*rays_)(column, row);
      const Verdict verdict = recollection.witness().was_there(
          k, transform(depth_from_color_[k], {ray.x() * live_m, ray.y() * live_m, live_m}));
      const float tolerance_m = between_cameras.at(z_m);
      if (is_changed(verdict)) continue;
      if (verdict == Verdict::unknown && is_nearer(live_m, x, y, tolerance_m)) continue;
      // Who looks from nearer by shows it better.
      if (recollection.baseline_m() > depth_from_color_m_[k]) continue;
      is_witnessed = std::abs(live_m - z_m) <= tolerance_m;
    }
    if (witnessed_only && !is_witnessed) continue;
    const Bgr color = mean_color(recollections, x, y);
    reconstruction.color(column, row) = {color.b, color.g, color.r, 255};
    reconstruction.depth_m(column, row) = z_m;
    reconstruction.source(column, row) =
        is_witnessed ? provenance::witnessed : provenance::remembered;
  }
}

void RecallMerge::drop_specks(const RecallInputs& inputs, Reconstruction& reconstruction) {
  constexpr int reach = 8;
  const int width = region_.width;
  const int height = region_.height;
  known_.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* const objects = inputs.masks.color.row(y + region_.y) + region_.x;
      const std::uint8_t* const source = reconstruction.source.row(y + region_.y) + region_.x;
      std::uint8_t* const known = known_.row(y);
      for (int x = 0; x < width; ++x) known[x] = objects[x] == 0 || source[x] != 0 ? 1 : 0;
    }
  });
  for_rows(height, [&](Rows rows) {
    // Of known pixels, in the rows within reach.
    column_sums_[rows.band].assign(static_cast<std::size_t>(width), 0);
    std::uint8_t* const sums = column_sums_[rows.band].data();
    const auto add = [&](int y) {
      if (y >= height) return;
      const std::uint8_t* const known = known_.row(y);
      for (int x = 0; x < width; ++x) sums[x] = static_cast<std::uint8_t>(sums[x] + known[x]);
    };
    const auto subtract = [&](int y) {
      if (y < 0) return;
      const std::uint8_t* const known = known_.row(y);
      for (int x = 0; x < width; ++x) sums[x] = static_cast<std::uint8_t>(sums[x] - known[x]);
    };
    for (int y = std::max(0, rows.first - reach); y < rows.first + reach; ++y) add(y);
    for (int y = rows.first; y < rows.last; ++y) {
      add(y + reach);
      if (y > rows.first) subtract(y - reach - 1);
      std::uint8_t* const source = reconstruction.source.row(y + region_.y) + region_.x;
      const int around_rows = std::min(height, y + reach + 1) - std::max(0, y - reach);
      const std::uint8_t* const next = std::find(source, source + width, provenance::remembered);
      int first = static_cast<int>(next - source);
      int last = first;  // the sum is of columns [first, last)
      int sum = 0;
      for (int x = first; x < width; ++x) {
        if (source[x] != provenance::remembered) continue;
        const int left = std::max(0, x - reach);
        const int right = std::min(width, x + reach + 1);
        if (left >= last) {
          first = last = left;
          sum = 0;
        }
        for (; first > left; --first) sum += sums[first - 1];
        for (; first < left; ++first) sum -= sums[first];
        for (; last < right; ++last) sum += sums[last];
        if (2 * sum < (right - left) * around_rows) source[x] = 0;
      }
    }
  });
}

void RecallMerge::merge(const RecallInputs& inputs, std::span<const Recollection> recollections,
                        bool witnessed_only, Reconstruction& reconstruction) {
  region_ = inputs.region;
  if (!rays_) rays_ = RayTable::of(color_);
  layer_.resize(region_.width, region_.height);
  depth_m_.resize(region_.width, region_.height);
  depth_from_color_.clear();
  depth_from_color_m_.clear();
  for (const auto& pose : inputs.poses.color_from_depth) {
    depth_from_color_.emplace_back(pose ? pose->inverse() : RigidTransform());
    depth_from_color_m_.push_back(pose ? pose->translation.norm() : 0);
  }
  usable_.clear();
  for (const Recollection& recollection : recollections) {
    usable_.push_back(explains_surroundings(inputs, recollection, reconstruction) ? 1 : 0);
  }
  for_rows(region_.height, [&](Rows rows) { layer_rows(recollections, rows); });
  for_rows(region_.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      merge_row(inputs, recollections, witnessed_only, y, reconstruction);
    }
  });
  drop_specks(inputs, reconstruction);
}

std::vector<std::size_t> RecallMerge::count_remembered(std::size_t recollections,
                                                       const Reconstruction& reconstruction) const {
  std::vector<std::size_t> counts(recollections);
  for (int y = 0; y < region_.height; ++y) {
    const std::uint8_t* const source = reconstruction.source.row(y + region_.y) + region_.x;
    const std::uint8_t* const layer = layer_.row(y);
    for (int x = 0; x < region_.width; ++x) {
      if (source[x] == provenance::remembered) ++counts[layer[x] - 1U];
    }
  }
  return counts;
}

}  // namespace diminish
