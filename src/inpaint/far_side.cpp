#include "inpaint/far_side.h"

#include <algorithm>
#include <cmath>

#include "core/runs.h"

namespace diminish {
namespace {

constexpr float least_step_m = 0.05F;
constexpr float reach_m = 2;  ///< beyond it the least step grows with the distance's square
/// Metres per metre: how fast the depth of a surface changes that is seen at 60 degrees.
constexpr float steepest = 1.7F;

/// z where a known pixel was measured, else 0. x, y: in the codes.
float depth_at(const FarSide::Input& input, int x, int y) {
  if ((input.codes(x, y) & input.open_bit) != 0) return 0;
  const int column = input.part.x + x;
  const int row = input.part.y + y;
  return input.measured.contains(column, row) ? input.depth_m(column, row) : 0;
}

/// Whether two pixels cannot lie on one surface. apart: pixels. A picture is about as wide as its
/// focal length.
bool are_apart(float z0_m, float z1_m, int apart, int width) {
  const float nearest = std::min(z0_m, z1_m);
  const float relative = nearest / reach_m;
  const float along_surface =
      steepest * nearest * static_cast<float>(apart) / static_cast<float>(width);
  return std::abs(z0_m - z1_m) > least_step_m * std::max(1.F, relative * relative) + along_surface;
}

}  // namespace

const std::vector<FarSide::Place>& FarSide::find_front(const Input& input) {
  front_.clear();
  const Image<std::uint8_t>& codes = input.codes;
  const int width = codes.width();
  const int picture_width = input.depth_m.width();
  const auto compare = [&](Place a, Place b, int apart) {
    const float z0 = depth_at(input, a.x, a.y);
    const float z1 = depth_at(input, b.x, b.y);
    if (z0 == 0 || z1 == 0 || !are_apart(z0, z1, apart, picture_width)) return;
    front_.push_back(z0 < z1 ? a : b);
  };
  above_.resize(static_cast<std::size_t>(width));
  is_below_.assign(static_cast<std::size_t>(width), 0);
  for (int y = 0; y < codes.height(); ++y) {
    const std::uint8_t* const row = codes.row(y);
    std::uint8_t* const is_below = is_below_.data();
    // Nothing is known above the first row.
    const auto begin_columns = [&](int first, int last) {
      for (int x = first; y > 0 && (x = find_equal(is_below, x, last, 0)) < last; ++x) {
        is_below[x] = 1;
        above_[static_cast<std::size_t>(x)] = y - 1;
      }
    };
    const auto end_columns = [&](int first, int last) {
      for (int x = first; (x = find_equal(is_below, x, last, 1)) < last; ++x) {
        is_below[x] = 0;
        const int above = above_[static_cast<std::size_t>(x)];
        compare({x, above}, {x, y}, y - above);
      }
    };
    for (int x = 0; x < width;) {
      const int begin = find_equal(row, x, width, input.hole);
      end_columns(x, begin);
      const int end = find_other(row, begin, width, input.hole);
      begin_columns(begin, end);
      if (begin > 0 && end < width) compare({begin - 1, y}, {end, y}, end - begin + 1);
      x = end;
    }
  }
  return front_;
}

}  // namespace diminish
