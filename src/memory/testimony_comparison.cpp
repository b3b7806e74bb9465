#include <algorithm>
#include <cmath>
#include <vector>

#include "core/channels.h"
#include "core/robust.h"
#include "core/rows.h"
#include "memory/keyframe.h"
#include "memory/light.h"
#include "memory/testimony.h"

namespace diminish {
namespace {

/// Of one depth sensor, at two moments.
constexpr DepthNoise usual_noise{0.012F, 0.006F};

/// Whether a surface ends near a pixel.
bool is_edge(const Image<float>& depth_m, int x, int y) {
  constexpr int reach = 2;
  constexpr float step = 0.04F;  // relative to the depth
  const float z = depth_m(x, y);
  if (!grow(depth_m.bounds(), -reach).contains(x, y)) return true;
  for (const auto& [dx, dy] : {std::pair{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) {
    if (!(std::abs(depth_m(x + dx, y + dy) - z) < step * z)) return true;
  }
  return false;
}

/// The depths around a pixel, and the colours of those that are near `z_m`.
struct Neighbourhood {
  float least_m = 1e9F, greatest_m = 0;
  int low[3] = {255, 255, 255}, high[3] = {}, sum[3] = {};
  int count = 0;  ///< of colours

  bool is_empty() const { return greatest_m == 0; }
  Neighbourhood(const Testimony& testimony, int x, int y, int reach, float z_m, float tolerance_m) {
    for (int row = y - reach; row <= y + reach; ++row) {
      const float* const depth_m = testimony.depth_m.row(row);
      const Bgr* const colors = testimony.color.row(row);
      for (int column = x - reach; column <= x + reach; ++column) {
        if (!(depth_m[column] > 0)) continue;
        least_m = std::min(least_m, depth_m[column]);
        greatest_m = std::max(greatest_m, depth_m[column]);
        if (std::abs(depth_m[column] - z_m) > tolerance_m) continue;
        const int levels[3] = {colors[column].b, colors[column].g, colors[column].r};
        for (int c = 0; c < 3; ++c) {
          low[c] = std::min(low[c], levels[c]);
          high[c] = std::max(high[c], levels[c]);
          sum[c] += levels[c];
        }
        ++count;
      }
    }
  }
  Eigen::Array3f mean() const { return channels(sum) / static_cast<float>(count); }
  static Eigen::Array3f channels(const int (&values)[3]) {
    return {static_cast<float>(values[0]), static_cast<float>(values[1]),
            static_cast<float>(values[2])};
  }
};

}  // namespace

TestimonyTaker::Difference TestimonyTaker::compare(const Testimony& a, const Testimony& b,
                                                   const FloatTransform& b_from_a,
                                                   const Tolerance& tolerance, int x, int y) const {
  const float z_in_a = a.depth_m(x, y);
  if (!(z_in_a > 0)) return {};
  const Eigen::Vector3f point = transform(b_from_a, point_m(x, y, z_in_a));
  const auto pixel = project(depth_, point, 1.F / Testimony::step);
  if (!pixel || !grow(b.depth_m.bounds(), -tolerance.reach).contains(pixel->x, pixel->y)) {
    return {};
  }
  const float z = point.z();
  const float noise_m = usual_noise.at(z);
  const Neighbourhood there(b, pixel->x, pixel->y, tolerance.reach, z, tolerance.depth * noise_m);
  if (there.is_empty()) return {};
  if (z < there.least_m - tolerance.depth * noise_m) return {Verdict::absent};
  if (z > there.greatest_m + tolerance.depth * noise_m) return {};
  const float center_m = b.depth_m(pixel->x, pixel->y);
  const float depth = center_m > 0 ? std::abs(z - center_m) / noise_m : 0;
  // Where surfaces end, colours are those of either side.
  constexpr float step = 0.04F;
  if (there.count == 0 || (tolerance.reach > 1 && (there.greatest_m - there.least_m > step * z ||
                                                   is_edge(a.depth_m, x, y)))) {
    return {Verdict::same, depth, 0};
  }
  const Eigen::Array3f own = to_channels(a.color(x, y));
  const Eigen::Array3f mean = there.mean();
  const float light = light_between(own, mean, 1 / deepest_shadow);
  const bool differs = (own < light * there.channels(there.low) - tolerance.color).any() ||
                       (own > light * there.channels(there.high) + tolerance.color).any();
  return {differs ? Verdict::recolored : Verdict::same, depth,
          (own - light * mean).abs().maxCoeff()};
}

int TestimonyTaker::count_same(const Testimony& a, const Testimony& b,
                               const FloatTransform& b_from_a, Tolerance& tolerance) const {
  constexpr int stride = 5;
  std::vector<float> depths;
  std::vector<float> colors;
  for (int y = stride; y < grid().height; y += stride) {
    for (int x = stride; x < grid().width; x += stride) {
      const Difference difference = compare(a, b, b_from_a, tolerance, x, y);
      if (difference.verdict != Verdict::same) continue;
      depths.push_back(difference.depth);
      colors.push_back(difference.color);
    }
  }
  const auto count = static_cast<int>(depths.size());
  if (count > 0) {
    tolerance.depth = std::clamp(6 * median(depths), 0.5F, 2.F);
    tolerance.color = std::clamp(5 * median(colors), 8.F, 30.F);
  }
  return count;
}

void TestimonyTaker::compare(const Side& a, const Side& b) const {
  for (const Side* side : {&a, &b}) {
    side->verdicts.resize(grid().width, grid().height, Verdict::unknown);
  }
  if (!a.testimony.is_given || !b.testimony.is_given) return;
  const RigidTransform b_from_a =
      b.testimony.depth_from_world * a.testimony.depth_from_world.inverse();
  Tolerance still;
  Tolerance moving;
  // Poses are never better than no motion at all.
  constexpr double nearly_as_many = 0.97;
  const int same_if_still =
      count_same(a.testimony, b.testimony, FloatTransform(RigidTransform()), still);
  const int same_if_moving = count_same(a.testimony, b.testimony, FloatTransform(b_from_a), moving);
  moving.reach = 2;
  const bool stands_still = same_if_still >= nearly_as_many * same_if_moving;
  const RigidTransform motion = stands_still ? RigidTransform() : b_from_a;
  const Tolerance& tolerance = stands_still ? still : moving;
  judge(a, b.testimony, FloatTransform(motion), tolerance);
  judge(b, a.testimony, FloatTransform(motion.inverse()), tolerance);
}

void TestimonyTaker::judge(const Side& side, const Testimony& other,
                           const FloatTransform& other_from_side,
                           const Tolerance& tolerance) const {
  const Rect part = intersect(side.part, grid());
  const auto for_each = [&](const auto& visit) {
    for_rows(part.height, [&](Rows rows) {
      for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
        for (int x = part.x; x < part.right(); ++x) visit(x, y);
      }
    });
  };
  Verdicts raw(grid().width, grid().height, Verdict::unknown);
  for_each([&](int x, int y) {
    raw(x, y) = compare(side.testimony, other, other_from_side, tolerance, x, y).verdict;
  });
  const auto count_changed = [&](int x, int y, int reach) {
    const Rect around = intersect(grow({x, y, 1, 1}, reach), part);
    int count = 0;
    for (int row = around.y; row < around.bottom(); ++row) {
      for (int column = around.x; column < around.right(); ++column) {
        count += is_changed(raw(column, row)) ? 1 : 0;
      }
    }
    return count;
  };
  // What changes is wider than the errors at the edges of things.
  const int reach = tolerance.reach;
  const int square = (2 * reach + 1) * (2 * reach + 1);
  Mask core(grid().width, grid().height, std::uint8_t{0});
  for_each([&](int x, int y) {
    if (is_changed(raw(x, y)) && count_changed(x, y, reach) == square) core(x, y) = 1;
  });
  constexpr int fewest = 4;
  Verdicts kept = raw;
  for_each([&](int x, int y) {
    if (!is_changed(raw(x, y))) return;
    const Rect around = intersect(grow({x, y, 1, 1}, reach + 1), part);
    if (count_nonzero(core, around) > 0) {
      if (raw(x, y) == Verdict::absent && reach == 1) kept(x, y) = Verdict::gone;
    } else if (reach > 1 || count_changed(x, y, 1) < fewest) {
      kept(x, y) = Verdict::same;
    }
  });
  // What is beside a change has probably changed, too.
  for_each([&](int x, int y) {
    Verdict& verdict = side.verdicts(x, y);
    verdict = kept(x, y);
    if (is_changed(verdict)) return;
    const Rect around = intersect(grow({x, y, 1, 1}, 1), part);
    for (int row = around.y; row < around.bottom(); ++row) {
      for (int column = around.x; column < around.right(); ++column) {
        const Verdict beside = kept(column, row);
        if (is_changed(beside)) verdict = std::min(beside, Verdict::recolored);
      }
    }
  });
}

}  // namespace diminish
