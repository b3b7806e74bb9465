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
    std::transform(measured_m, measured_m + known.width, own_least_m_.at(known.x, y),
                   [](float z_m) { return z_m > 0 ? z_m : nothing_m; });
    std::uint8_t* const low = own_low_.at(known.x, y);
    std::uint8_t* const high = own_high_.at(known.x, y);
    std::copy_n(&colors->b, 3 * known.width, low);
    std::copy_n(&colors->b, 3 * known.width, high);
    for (int i = 0; i < known.width; ++i) {
      if (measured_m[i] > 0) continue;
      std::fill_n(low + 3 * i, 3, std::uint8_t{255});
      std::fill_n(high + 3 * i, 3, std::uint8_t{0});
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
