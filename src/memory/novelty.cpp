#include "memory/novelty.h"

#include <algorithm>
#include <limits>

#include "core/rows.h"
#include "geometry/point_rows.h"

namespace diminish {
namespace {

constexpr double always = -std::numeric_limits<double>::infinity();
/// Grid places that another one may be taken for, by errors of the poses.
constexpr int novelty_reach = 2;
constexpr int color_tolerance = 25;

/// Whether a colour is not between two others.
bool differs(const Bgr& color, const std::uint8_t* low, const std::uint8_t* high) {
  const int levels[3] = {color.b, color.g, color.r};
  bool result = false;
  for (int c = 0; c < 3; ++c) {
    result =
        result || levels[c] < low[c] - color_tolerance || levels[c] > high[c] + color_tolerance;
  }
  return result;
}

}  // namespace

void Novelty::filter(bool is_uncertain, Keyframe& keyframe) {
  const int width = keyframe.depth.width();
  const int height = keyframe.depth.height();
  const bool is_first = depth_m_.empty();
  const FloatTransform then_from_now(
      is_first ? RigidTransform() : color_from_world_ * keyframe.color_from_world.inverse());
  const Rect inside = grow(keyframe.depth.bounds(), -novelty_reach);
  now_depth_m_.resize(width, height);
  grid_.sample(keyframe.picture, now_color_);
  now_since_s_.resize(width, height);
  if (!is_first) around_.find(depth_m_, color_, novelty_reach, inside);
  const double unseen_before_s = is_uncertain ? keyframe.stamp_s : always;
  const auto since_s = [&](const Bgr& color, float z_m, std::int32_t place) {
    if (place < 0) return unseen_before_s;
    const int y = place / width;
    const int x = place - y * width;
    const float greatest_m = around_.greatest_m(x, y);
    if (greatest_m == 0) return unseen_before_s;
    const float tolerance_m = between_cameras.at(z_m);
    if (z_m > greatest_m + tolerance_m) return always;
    const bool is_new = z_m < around_.least_m(x, y) - tolerance_m ||
                        differs(color, around_.low(x, y), around_.high(x, y));
    return is_new ? keyframe.stamp_s : since_s_(x, y);
  };
  for_rows(height, [&](Rows rows) {
    float then_m[KeyframeGrid::most_columns];
    std::int32_t places[KeyframeGrid::most_columns];
    for (int y = rows.first; y < rows.last; ++y) {
      float* const now_m = now_depth_m_.row(y);
      for (int x = 0; x < width; ++x) {
        now_m[x] = KeyframeGrid::depth_m(keyframe.depth(x, y));
      }
      find_pixels({grid_.rays().x(y), grid_.rays().y(y), now_m, width},
                  {then_from_now, grid_.lens(), inside, width}, places, then_m);
      for (int x = 0; x < width; ++x) {
        const bool is_asked = !is_first && now_m[x] > 0;
        now_since_s_(x, y) = is_asked ? since_s(now_color_(x, y), then_m[x], places[x]) : always;
        if (keyframe.stamp_s - now_since_s_(x, y) < stay_s) keyframe.depth(x, y) = 0;
      }
    }
  });
  color_from_world_ = keyframe.color_from_world;
  std::swap(depth_m_, now_depth_m_);
  std::swap(color_, now_color_);
  std::swap(since_s_, now_since_s_);
}

}  // namespace diminish
