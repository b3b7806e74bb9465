#include "detect/color_blob/outline.h"

#include <array>
#include <cstdint>
#include <cstdlib>

namespace diminish {

void trace_outline(const Mask& mask, const Eigen::Vector2i& first, Outline& outline) {
  // Clockwise, as y points down.
  static const std::array<Eigen::Vector2i, 8> directions = {
      Eigen::Vector2i{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  const auto is_set = [&](const Eigen::Vector2i& pixel) {
    return mask.bounds().contains(pixel.x(), pixel.y()) && mask(pixel.x(), pixel.y()) != 0;
  };
  outline.clear();
  Eigen::Vector2i pixel = first;
  int first_step = -1;
  int search = 0;  // nothing of the region is above or to the left of its first pixel
  for (;;) {
    int step = -1;
    for (int i = 0; i < 8 && step < 0; ++i) {
      const int direction = (search + i) % 8;
      if (is_set(pixel + directions[direction])) step = direction;
    }
    if (!outline.empty() && pixel == first && step == first_step) return;
    outline.push_back(pixel);
    if (step < 0) return;  // a single pixel
    if (first_step < 0) first_step = step;
    pixel += directions[step];
    // Next to where it came from, on the outer side: that one was empty.
    search = (step + (step % 2 == 0 ? 7 : 6)) % 8;
  }
}

double polygon_area(const Outline& outline) {
  std::int64_t doubled = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2i& a = outline[i];
    const Eigen::Vector2i& b = outline[i + 1 < outline.size() ? i + 1 : 0];
    doubled += std::int64_t{a.x()} * b.y() - std::int64_t{a.y()} * b.x();
  }
  return static_cast<double>(std::abs(doubled)) / 2;
}

}  // namespace diminish
