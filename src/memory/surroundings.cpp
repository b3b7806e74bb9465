#include "memory/surroundings.h"

namespace diminish {

void Surroundings::find(const Image<float>& depth_m, const Image<Bgr>& color, int reach,
                        const Rect& part) {
  const Rect grid = depth_m.bounds();
  for (Padded<float>* image : {&own_least_m_, &least_m_}) image->resize(grid, 1, nothing_m);
  for (Padded<float>* image : {&own_greatest_m_, &greatest_m_, &depths_across_}) {
    image->resize(grid, 1, 0);
  }
  for (Padded<std::uint8_t>* image : {&own_low_, &low_}) image->resize(grid, 3, 255);
  for (Padded<std::uint8_t>* image : {&own_high_, &high_, &colors_across_}) {
    image->resize(grid, 3, 0);
  }
  const Rect known = intersect(grow(part, reach), grid);
  for (int y = known.y; y < known.bottom(); ++y) {
    const float* const measured_m = depth_m.row(y) + known.x;
    const Bgr* const colors = color.row(y) + known.x;
    std::copy_n(measured_m, known.width, own_greatest_m_.at(known.x, y));
    float* const least_m = own_least_m_.at(known.x, y);
    std::uint8_t* low = own_low_.at(known.x, y);
    std::uint8_t* high = own_high_.at(known.x, y);
    for (int i = 0; i < known.width; ++i, low += 3, high += 3) {
      const bool is_measured = measured_m[i] > 0;
      least_m[i] = is_measured ? measured_m[i] : nothing_m;
      const int lowest = is_measured ? 0 : 255;
      const int highest = is_measured ? 255 : 0;
      const int levels[3] = {colors[i].b, colors[i].g, colors[i].r};
      for (int c = 0; c < 3; ++c) {
        low[c] = static_cast<std::uint8_t>(levels[c] | lowest);
        high[c] = static_cast<std::uint8_t>(levels[c] & highest);
      }
    }
  }
  const auto least = [](auto a, auto b) { return std::min(a, b); };
  const auto greatest = [](auto a, auto b) { return std::max(a, b); };
  combine_around(own_least_m_, part, reach, least, depths_across_, least_m_);
  combine_around(own_greatest_m_, part, reach, greatest, depths_across_, greatest_m_);
  combine_around(own_low_, part, reach, least, colors_across_, low_);
  combine_around(own_high_, part, reach, greatest, colors_across_, high_);
}

}  // namespace diminish
