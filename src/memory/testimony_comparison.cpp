#include "memory/testimony_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/channels.h"
#include "core/conditions.h"
#include "core/robust.h"
#include "geometry/point_rows.h"
#include "memory/light.h"

namespace diminish {
namespace {

/// Of one depth sensor, at two moments.
constexpr DepthNoise usual_noise{0.012F, 0.006F};
/// Where depths differ by more, relative to themselves, a surface ends.
constexpr float edge = 0.04F;

/// Whether a surface ends near a pixel.
bool is_edge(const Image<float>& depth_m, int x, int y) {
  constexpr int reach = 2;
  const float z = depth_m(x, y);
  if (!grow(depth_m.bounds(), -reach).contains(x, y)) return true;
  for (const auto& [dx, dy] : {std::pair{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) {
    if (!(std::abs(depth_m(x + dx, y + dy) - z) < edge * z)) return true;
  }
  return false;
}

/// Whether a colour lies between two others, in any light.
bool is_between(const Bgr& color, const std::uint8_t* low, const std::uint8_t* high,
                float tolerance) {
  const float own[3] = {static_cast<float>(color.b), static_cast<float>(color.g),
                        static_cast<float>(color.r)};
  const auto is_within = [&](float light) {
    bool within = true;
    for (int c = 0; c < 3; ++c) {
      within = within && own[c] >= light * static_cast<float>(low[c]) - tolerance &&
               own[c] <= light * static_cast<float>(high[c]) + tolerance;
    }
    return within;
  };
  if (is_within(1)) return true;
  const auto middle = [&](int c) { return static_cast<float>(low[c] + high[c]) / 2; };
  return is_within(light_between({own[0], own[1], own[2]}, {middle(0), middle(1), middle(2)},
                                 1 / deepest_shadow));
}

/// Whether levels lie between two others, or nearly: 1 or 0.
void are_within(const std::uint8_t* levels, const std::uint8_t* low, const std::uint8_t* high,
                int count, int tolerance, std::uint8_t* within) {
  for (int i = 0; i < count; ++i) {
    within[i] = all_of(levels[i] + tolerance >= low[i], levels[i] <= high[i] + tolerance) ? 1 : 0;
  }
}

/// Whether a measured depth is that of a surface around, without an edge: 1 or 0.
void are_near(const float* depth_m, const float* least_m, const float* greatest_m, int count,
              float tolerance, std::uint8_t* near) {
  for (int i = 0; i < count; ++i) {
    const float z_m = depth_m[i];
    const float tolerance_m = tolerance * usual_noise.at(z_m);
    near[i] = all_of(z_m > 0, z_m >= least_m[i] - tolerance_m, z_m <= greatest_m[i] + tolerance_m,
                     greatest_m[i] - least_m[i] <= edge * z_m)
                  ? 1
                  : 0;
  }
}

}  // namespace

int TestimonyComparison::count_same(const Testimony& a, const Testimony& b,
                                    const FloatTransform& b_from_a, Tolerance& tolerance) {
  constexpr int rows_apart = 6;
  constexpr int columns_apart = 4;
  const Rect& grid = grid_.bounds();
  depth_differences_.clear();
  color_differences_.clear();
  std::int32_t places[TestimonyGrid::most_columns];
  float depths[TestimonyGrid::most_columns];
  for (int y = rows_apart / 2; y < grid.height; y += rows_apart) {
    find_pixels({grid_.rays().x(y), grid_.rays().y(y), a.depth_m.row(y), grid.width},
                {b_from_a, grid_.lens(), grid, grid.width}, places, depths);
    for (int x = columns_apart / 2; x < grid.width; x += columns_apart) {
      if (places[x] < 0) continue;
      const float z = depths[x];
      const float noise_m = usual_noise.at(z);
      const float difference_m = std::abs(z - b.depth_m.data()[places[x]]);
      if (!(difference_m <= tolerance.depth * noise_m)) continue;
      const Eigen::Array3f own = to_channels(a.color(x, y));
      const Eigen::Array3f other = to_channels(b.color.data()[places[x]]);
      const float light = light_between(own, other, 1 / deepest_shadow);
      const float difference = (own - light * other).abs().maxCoeff();
      if (difference > tolerance.color) continue;
      depth_differences_.push_back(difference_m / noise_m);
      color_differences_.push_back(difference);
    }
  }
  const auto count = static_cast<int>(depth_differences_.size());
  if (count > 0) {
    tolerance.depth = std::clamp(6 * median(depth_differences_), 0.5F, 2.F);
    tolerance.color = std::clamp(4 * median(color_differences_), 8.F, 30.F);
  }
  return count;
}

void TestimonyComparison::compare(const Side& a, const Side& b) {
  for (const Side* side : {&a, &b}) {
    side->verdicts.resize(grid_.bounds().width, grid_.bounds().height, Verdict::unknown);
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
  judge(a, b, FloatTransform(motion), tolerance);
  judge(b, a, FloatTransform(motion.inverse()), tolerance);
}

Verdict TestimonyComparison::verdict_of(const Place& own, const Place& there,
                                        const Tolerance& tolerance) const {
  const float least_m = around_.least_m(there.x, there.y);
  const float greatest_m = around_.greatest_m(there.x, there.y);
  if (!(greatest_m > 0)) return Verdict::unknown;
  const float z_m = there.z_m;
  const float tolerance_m = tolerance.depth * usual_noise.at(z_m);
  if (z_m < least_m - tolerance_m) return Verdict::absent;
  if (z_m > greatest_m + tolerance_m) return Verdict::unknown;
  const std::uint8_t* low = around_.low(there.x, there.y);
  const std::uint8_t* high = around_.high(there.x, there.y);
  std::uint8_t low_of_surface[3] = {255, 255, 255};
  std::uint8_t high_of_surface[3] = {};
  if (greatest_m - least_m > edge * z_m) {
    // Where surfaces end, colours are those of either side.
    if (tolerance.reach > 1) return Verdict::same;
    bool any = false;
    for (int y = there.y - 1; y <= there.y + 1; ++y) {
      for (int x = there.x - 1; x <= there.x + 1; ++x) {
        const float z = there.testimony.depth_m(x, y);
        if (!(z > 0) || std::abs(z - z_m) > tolerance_m) continue;
        any = true;
        const Bgr& color = there.testimony.color(x, y);
        const std::uint8_t levels[3] = {color.b, color.g, color.r};
        for (int c = 0; c < 3; ++c) {
          low_of_surface[c] = std::min(low_of_surface[c], levels[c]);
          high_of_surface[c] = std::max(high_of_surface[c], levels[c]);
        }
      }
    }
    if (!any) return Verdict::same;
    low = low_of_surface;
    high = high_of_surface;
  } else if (tolerance.reach > 1 && is_edge(own.testimony.depth_m, own.x, own.y)) {
    return Verdict::same;
  }
  return is_between(own.testimony.color(own.x, own.y), low, high, tolerance.color)
             ? Verdict::same
             : Verdict::recolored;
}

void TestimonyComparison::find_sure(const Testimony& own, const Rect& row,
                                    const Tolerance& tolerance) {
  const auto room = static_cast<std::size_t>(row.width);
  sure_.resize(room);
  colors_sure_.resize(3 * room);
  are_within(&own.color(row.x, row.y).b, around_.low(row.x, row.y), around_.high(row.x, row.y),
             3 * row.width, static_cast<int>(tolerance.color), colors_sure_.data());
  are_near(own.depth_m.row(row.y) + row.x, around_.least_row_m(row.x, row.y),
           around_.greatest_row_m(row.x, row.y), row.width, tolerance.depth, sure_.data());
  for (std::size_t i = 0; i < room; ++i) {
    const std::uint8_t* const sure = colors_sure_.data() + 3 * i;
    sure_[i] = static_cast<std::uint8_t>(sure_[i] & sure[0] & sure[1] & sure[2]);
  }
}

void TestimonyComparison::judge(const Side& side, const Side& other,
                                const FloatTransform& other_from_side, const Tolerance& tolerance) {
  const Rect& grid = grid_.bounds();
  const Rect inside = intersect(grow(grid, -tolerance.reach), other.part);
  Rect part = intersect(side.part, grid);
  if (tolerance.reach == 1) part = intersect(part, inside);
  if (part.empty() || inside.empty()) return;
  around_.find(other.testimony.depth_m, other.testimony.color, tolerance.reach, inside);
  const Testimony& own = side.testimony;
  const PointView view{other_from_side, grid_.lens(), inside, grid.width};
  std::int32_t places[TestimonyGrid::most_columns];
  float depths[TestimonyGrid::most_columns];
  bool any = false;
  for (int y = part.y; y < part.bottom(); ++y) {
    const float* const depth_m = own.depth_m.row(y) + part.x;
    if (tolerance.reach > 1) {
      find_pixels({grid_.rays().x(y) + part.x, grid_.rays().y(y) + part.x, depth_m, part.width},
                  view, places, depths);
    } else {
      for (int i = 0; i < part.width; ++i) {
        places[i] = depth_m[i] > 0 ? y * grid.width + part.x + i : -1;
        depths[i] = depth_m[i];
      }
    }
    Verdict* const verdicts = side.verdicts.row(y) + part.x;
    if (tolerance.reach == 1) {
      find_sure(own, {part.x, y, part.width, 1}, tolerance);
    } else {
      sure_.assign(static_cast<std::size_t>(part.width), 0);
    }
    for (int i = 0; i < part.width; ++i) {
      if (sure_[static_cast<std::size_t>(i)] != 0) {
        verdicts[i] = Verdict::same;
        continue;
      }
      if (places[i] < 0) continue;
      const int row = places[i] / grid.width;
      const int column = places[i] - row * grid.width;
      verdicts[i] = verdict_of({own, part.x + i, y, depth_m[i]},
                               {other.testimony, column, row, depths[i]}, tolerance);
      any = any || is_changed(verdicts[i]);
    }
  }
  if (any) keep_wide_changes(part, tolerance.reach, side.verdicts);
}

void TestimonyComparison::keep_wide_changes(const Rect& part, int reach, Verdicts& verdicts) {
  for (Padded<std::uint8_t>* image : {&changed_, &core_, &count_, &kept_, &across_}) {
    image->resize(grid_.bounds(), 1, 0);
  }
  changed_.fill(0);
  core_.fill(0);
  for (int y = part.y; y < part.bottom(); ++y) {
    const Verdict* const verdict = verdicts.row(y) + part.x;
    std::uint8_t* const changed = changed_.at(part.x, y);
    for (int i = 0; i < part.width; ++i) changed[i] = is_changed(verdict[i]) ? 1 : 0;
  }
  const auto least = [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); };
  const auto greatest = [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); };
  const auto sum = [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + b); };
  combine_around(changed_, part, reach, least, across_, core_);
  combine_around(core_, part, reach + 1, greatest, across_, kept_);
  combine_around(changed_, part, 1, sum, across_, count_);
  // What is left of `changed_`: the verdicts on wide changes.
  constexpr int fewest = 4;
  for (int y = part.y; y < part.bottom(); ++y) {
    Verdict* const verdict = verdicts.row(y) + part.x;
    std::uint8_t* const changed = changed_.at(part.x, y);
    const std::uint8_t* const is_wide = kept_.at(part.x, y);
    const std::uint8_t* const count = count_.at(part.x, y);
    for (int i = 0; i < part.width; ++i) {
      if (changed[i] == 0) continue;
      if (is_wide[i] != 0) {
        if (verdict[i] == Verdict::absent && reach == 1) verdict[i] = Verdict::gone;
      } else if (reach > 1 || count[i] < fewest) {
        verdict[i] = Verdict::same;
      }
      changed[i] = is_changed(verdict[i]) ? static_cast<std::uint8_t>(verdict[i]) : 0;
    }
  }
  // What is beside a change has probably changed, too.
  combine_around(changed_, part, 1, greatest, across_, kept_);
  for (int y = part.y; y < part.bottom(); ++y) {
    Verdict* const verdict = verdicts.row(y) + part.x;
    const std::uint8_t* const beside = kept_.at(part.x, y);
    for (int i = 0; i < part.width; ++i) {
      if (beside[i] == 0 || is_changed(verdict[i])) continue;
      verdict[i] = std::min(static_cast<Verdict>(beside[i]), Verdict::recolored);
    }
  }
}

}  // namespace diminish
