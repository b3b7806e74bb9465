#include "memory/stands_still.h"

#include <cmath>
#include <vector>

#include "core/channels.h"

namespace diminish {

bool stands_still(const Testimony& then, const Testimony& now) {
  constexpr int stride = 5;
  constexpr DepthNoise most{0.036F, 0.018F};
  constexpr float color_tolerance = 30;  // levels
  constexpr std::size_t fewest = 50;
  struct Pair {
    bool is_as_far;
    Eigen::Array3f then, now;
  };
  std::vector<Pair> pairs;
  Eigen::Array3f sum_then = Eigen::Array3f::Constant(1);
  Eigen::Array3f sum_now = Eigen::Array3f::Constant(1);
  for (int y = 0; y < now.depth_m.height(); y += stride) {
    for (int x = 0; x < now.depth_m.width(); x += stride) {
      const float z = now.depth_m(x, y);
      if (!(z > 0) || !(then.depth_m(x, y) > 0)) continue;
      pairs.push_back({std::abs(then.depth_m(x, y) - z) <= most.at(z),
                       to_channels(then.color(x, y)), to_channels(now.color(x, y))});
      sum_then += pairs.back().then;
      sum_now += pairs.back().now;
    }
  }
  // Too little to tell.
  if (pairs.size() < fewest) return true;
  const Eigen::Array3f light = sum_now / sum_then;
  std::size_t same = 0;
  for (const Pair& pair : pairs) {
    const bool looks_alike = ((light * pair.then - pair.now).abs() < color_tolerance).all();
    same += pair.is_as_far && looks_alike ? 1 : 0;
  }
  return 2 * same >= pairs.size();
}

}  // namespace diminish
