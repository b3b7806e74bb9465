#include "memory/recall_merge.h"

#include <algorithm>
#include <cmath>

#include "core/channels.h"
#include "core/conditions.h"
#include "core/rows.h"
#include "core/runs.h"
#include "geometry/point_rows.h"
#include "memory/light.h"

namespace diminish {
namespace {

Eigen::Array3f mapped(const ColorMap& map, const Bgra& color, int x, int y) {
  return map(to_channels({color.b, color.g, color.r}), static_cast<float>(x),
             static_cast<float>(y));
}

// Bytes may be anything, for a compiler, but not a count that is passed by value.
void add_row(const std::uint8_t* row, int width, std::uint8_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] = static_cast<std::uint8_t>(sums[x] + row[x]);
}
void subtract_row(const std::uint8_t* row, int width, std::uint8_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] = static_cast<std::uint8_t>(sums[x] - row[x]);
}

/// Puts what a recollection shows where there is nothing yet.
void layer_run(const std::uint8_t* source, const float* drawn_m, int count, std::uint8_t name,
               std::uint8_t* layer, float* depth_m) {
  for (int i = 0; i < count; ++i) {
    const bool is_next = all_of(layer[i] == 0, source[i] != 0);
    const float own_m = drawn_m[i];
    layer[i] = is_next ? name : layer[i];
    depth_m[i] = is_next ? own_m : depth_m[i];
  }
}

}  // namespace

RecallMerge::RecallMerge(const Intrinsics& color) : color_(color) {}

bool RecallMerge::explains_surroundings(const RecallInputs& inputs,
                                        const Recollection& recollection,
                                        ColorMapsBySource color_maps, const Reconstruction& live) {
  constexpr float most = 60;  // levels: more is no worse
  constexpr auto fewest = static_cast<int>(Recollection::fewest_beside);
  constexpr float slack = 4;    // levels
  constexpr float enough = 12;  // levels, where the cameras see too little to compare with
  float error = 0;
  float shared_error = 0;
  float live_error = 0;
  int count = 0;
  int shared = 0;
  for (const auto& [x, y, color] : recollection.beside()) {
    const Eigen::Array3f seen = to_channels(inputs.frame.color(x, y));
    // The objects' shadows are in one of the two only.
    const auto difference = [&](const Eigen::Array3f& own) {
      return std::min(most, (light_between(seen, own, 1) * own - seen).abs().mean());
    };
    const float own = difference(recollection.mapped(color.b, color.g, color.r));
    error += own;
    ++count;
    const std::uint8_t source = live.source(x, y);
    if (source == 0) continue;
    live_error += difference(mapped(color_maps[source], live.color(x, y), x, y));
    shared_error += own;
    ++shared;
  }
  if (shared >= fewest) {
    const auto n = static_cast<float>(shared);
    return shared_error / n <= live_error / n + slack;
  }
  return count >= fewest && error / static_cast<float>(count) <= enough;
}

void RecallMerge::layer_row(std::span<const Recollection> recollections, int y) {
  std::uint8_t* const layer = layer_.row(y - part_.y);
  float* const depth_m = depth_m_.row(y - part_.y);
  std::fill_n(layer, part_.width, std::uint8_t{0});
  for (std::size_t i = 0; i < recollections.size(); ++i) {
    const TiledRegion& own = recollections[i].part();
    if (usable_[i] == 0 || y < own.y || y >= own.bottom()) continue;
    const Reconstruction& drawn = recollections[i].drawn();
    own.for_each_run(y, [&](int first, int last) {
      layer_run(drawn.source.row(y) + first, drawn.depth_m.row(y) + first, last - first,
                static_cast<std::uint8_t>(1 + i), layer + first - part_.x,
                depth_m + first - part_.x);
    });
  }
}

bool RecallMerge::is_nearer(float z_m, int x, int y, float tolerance_m) const {
  constexpr int reach = 5;  // edges of the cameras' surfaces are off by some pixels
  const Rect around = intersect(grow({x - part_.x, y - part_.y, 1, 1}, reach), layer_.bounds());
  for (int row = around.y; row < around.bottom(); ++row) {
    for (int column = around.x; column < around.right(); ++column) {
      if (layer_(column, row) != 0 && !(z_m < depth_m_(column, row) - tolerance_m)) return false;
    }
  }
  return true;
}

Bgr RecallMerge::mean_color(std::span<const Recollection> recollections, int x, int y) const {
  constexpr float other_surface = 60;  // levels
  const auto color_of = [&](const Recollection& recollection) {
    const Bgra& color = recollection.drawn().color(x, y);
    return recollection.mapped(color.b, color.g, color.r);
  };
  const std::size_t best = layer_(x - part_.x, y - part_.y) - 1U;
  const float z_m = depth_m_(x - part_.x, y - part_.y);
  const Eigen::Array3f best_color = color_of(recollections[best]);
  const float tolerance_m = between_cameras.at(z_m);
  Eigen::Array3f sum = best_color;
  int count = 1;
  for (std::size_t i = best + 1; i < recollections.size(); ++i) {
    const Reconstruction& drawn = recollections[i].drawn();
    if (usable_[i] == 0 || drawn.source(x, y) == 0 ||
        std::abs(drawn.depth_m(x, y) - z_m) > tolerance_m) {
      continue;
    }
    const Eigen::Array3f color = color_of(recollections[i]);
    if ((color - best_color).abs().maxCoeff() > other_surface) continue;
    sum += color;
    ++count;
  }
  return to_color(sum / static_cast<float>(count));
}

void RecallMerge::find_verdicts(const Run& run, const RecallInputs& inputs,
                                std::span<const Recollection> recollections,
                                const Reconstruction& live, Scratch& scratch) const {
  const auto& [first, last, y] = run;
  const int count = last - first;
  const auto room = static_cast<std::size_t>(count);
  scratch.verdicts.assign(room, Verdict::unknown);
  scratch.looked_m.resize(room);
  scratch.places.resize(room);
  const std::uint8_t* const layer = layer_.row(y - part_.y) + first - part_.x;
  const std::uint8_t* const masked = inputs.masks.color.row(y) + first;
  const std::uint8_t* const source = live.source.row(y) + first;
  const float* const live_m = live.depth_m.row(y) + first;
  float* const looked_m = scratch.looked_m.data();
  std::int32_t* const places = scratch.places.data();
  for (std::size_t k = 0; k < depth_from_color_.size(); ++k) {
    bool any = false;
    for (int i = 0; i < count; ++i) {
      const bool is_asked = source[i] == k + 1 && layer[i] != 0 && masked[i] != 0;
      looked_m[i] = is_asked ? live_m[i] : 0;
      any = any || is_asked;
    }
    if (!any) continue;
    const TestimonyGrid& grid = recollections[0].witness().grid(k);
    find_pixels({rays_->x(y) + first, rays_->y(y) + first, looked_m, count},
                {depth_from_color_[k], grid.lens(), grid.bounds(), grid.bounds().width}, places,
                looked_m);
    for (int i = 0; i < count; ++i) {
      if (places[i] < 0) continue;
      scratch.verdicts[static_cast<std::size_t>(i)] =
          recollections[layer[i] - 1U].witness().was_there(k, places[i]);
    }
  }
}

bool RecallMerge::merge_run(const Run& run, const RecallInputs& inputs,
                            std::span<const Recollection> recollections,
                            ColorMapsBySource color_maps, bool witnessed_only, Scratch& scratch,
                            Reconstruction& reconstruction) const {
  find_verdicts(run, inputs, recollections, reconstruction, scratch);
  const int y = run.y;
  const std::uint8_t* const layer = layer_.row(y - part_.y) - part_.x;
  const float* const depth_m = depth_m_.row(y - part_.y) - part_.x;
  const std::uint8_t* const masked = inputs.masks.color.row(y);
  std::uint8_t* const source = reconstruction.source.row(y);
  bool any_remembered = false;
  for (int x = run.first; x < run.last; ++x) {
    if (layer[x] == 0 || masked[x] == 0) continue;
    const float z_m = depth_m[x];
    bool is_witnessed = false;
    if (source[x] != 0) {
      const float live_m = reconstruction.depth_m(x, y);
      const float tolerance_m = between_cameras.at(z_m);
      const Verdict verdict = scratch.verdicts[static_cast<std::size_t>(x - run.first)];
      if (is_changed(verdict)) continue;
      if (verdict == Verdict::unknown && is_nearer(live_m, x, y, tolerance_m)) continue;
      // Who looks from nearer by shows it better.
      if (baselines_m_[layer[x] - 1U] > depth_from_color_m_[source[x] - 1U]) continue;
      is_witnessed = std::abs(live_m - z_m) <= tolerance_m;
    }
    if (witnessed_only && !is_witnessed) continue;
    const Bgr color = mean_color(recollections, x, y);
    if (is_witnessed && x % LightRatio::step == 0 && y % LightRatio::step == 0) {
      scratch.pairs.push_back({x, y,
                               mapped(color_maps[source[x]], reconstruction.color(x, y), x, y),
                               to_channels(color)});
    }
    reconstruction.color(x, y) = {color.b, color.g, color.r, 255};
    reconstruction.depth_m(x, y) = z_m;
    source[x] = is_witnessed ? provenance::witnessed : provenance::remembered;
    any_remembered = any_remembered || !is_witnessed;
  }
  return any_remembered;
}

void RecallMerge::drop_specks(const RecallInputs& inputs, Reconstruction& reconstruction) {
  constexpr int reach = 8;
  TiledRegion& part = specks_part_;
  part.set(intersect(grow(part_, reach), inputs.region));
  part.keep_if([&](const Rect& tile) { return part_.touches(grow(tile, reach)); });
  const int width = part.width;
  const int height = part.height;
  known_.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* const objects = inputs.masks.color.row(y + part.y);
      const std::uint8_t* const source = reconstruction.source.row(y + part.y);
      std::uint8_t* const known = known_.row(y) - part.x;
      part.for_each_run(y + part.y, [&](int first, int last) {
        for (int x = first; x < last; ++x) {
          known[x] = any_of(objects[x] == 0, source[x] != 0) ? 1 : 0;
        }
      });
    }
  });
  for_rows(height, [&](Rows rows) {
    // Of known pixels, in the rows within reach.
    column_sums_[rows.band].assign(static_cast<std::size_t>(width), 0);
    std::uint8_t* const sums = column_sums_[rows.band].data();
    const auto add = [&](int y) {
      if (y < height) add_row(known_.row(y), width, sums);
    };
    const auto subtract = [&](int y) {
      if (y >= 0) subtract_row(known_.row(y), width, sums);
    };
    for (int y = std::max(0, rows.first - reach); y < rows.first + reach; ++y) add(y);
    for (int y = rows.first; y < rows.last; ++y) {
      add(y + reach);
      if (y > rows.first) subtract(y - reach - 1);
      std::uint8_t* const source = reconstruction.source.row(y + part.y) + part.x;
      const int around_rows = std::min(height, y + reach + 1) - std::max(0, y - reach);
      int first = find_equal(source, 0, width, provenance::remembered);
      int last = first;  // the sum is of columns [first, last)
      int sum = 0;
      for (int x = first; x < width; x = find_equal(source, x + 1, width, provenance::remembered)) {
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
                        ColorMapsBySource color_maps, bool witnessed_only,
                        Reconstruction& reconstruction) {
  Rect box;
  for (const Recollection& recollection : recollections) box = join(box, recollection.part());
  part_.set(box);
  part_.keep_if([&](const Rect& tile) {
    return std::any_of(
        recollections.begin(), recollections.end(),
        [&](const Recollection& recollection) { return recollection.part().touches(tile); });
  });
  if (!rays_) rays_ = RayTable::of(color_);
  layer_.resize(part_.width, part_.height);
  depth_m_.resize(part_.width, part_.height);
  depth_from_color_.clear();
  depth_from_color_m_.clear();
  for (const auto& pose : inputs.poses.color_from_depth) {
    depth_from_color_.emplace_back(pose ? pose->inverse() : RigidTransform());
    depth_from_color_m_.push_back(pose ? pose->translation.norm() : 0);
  }
  usable_.clear();
  baselines_m_.clear();
  for (const Recollection& recollection : recollections) {
    usable_.push_back(explains_surroundings(inputs, recollection, color_maps, reconstruction) ? 1
                                                                                              : 0);
    baselines_m_.push_back(recollection.baseline_m());
  }
  for_rows(part_.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) layer_row(recollections, part_.y + y);
  });
  for (Scratch& scratch : scratch_) scratch.pairs.clear();
  const int remembering_rows = sum_over_rows(part_.height, [&](Rows rows) {
    int count = 0;
    for (int y = part_.y + rows.first; y < part_.y + rows.last; ++y) {
      part_.for_each_run(y, [&](int first, int last) {
        count += merge_run({first, last, y}, inputs, recollections, color_maps, witnessed_only,
                           scratch_[rows.band], reconstruction)
                     ? 1
                     : 0;
      });
    }
    return count;
  });
  light_.begin(part_);
  for (const Scratch& scratch : scratch_) light_.add(scratch.pairs);
  light_.solve();
  light_.apply(inputs.masks.color, reconstruction);
  if (remembering_rows > 0) drop_specks(inputs, reconstruction);
}

std::vector<std::size_t> RecallMerge::count_remembered(std::size_t recollections,
                                                       const Reconstruction& reconstruction) const {
  std::vector<std::size_t> counts(recollections);
  for (int y = part_.y; y < part_.bottom(); ++y) {
    const std::uint8_t* const source = reconstruction.source.row(y);
    const std::uint8_t* const layer = layer_.row(y - part_.y) - part_.x;
    part_.for_each_run(y, [&](int first, int last) {
      for (int x = first; x < last; ++x) {
        if (source[x] == provenance::remembered) ++counts[layer[x] - 1U];
      }
    });
  }
  return counts;
}

}  // namespace diminish
