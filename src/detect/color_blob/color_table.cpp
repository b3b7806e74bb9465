#include "detect/color_blob/color_table.h"

#include <algorithm>
#include <array>

namespace diminish {
namespace {

std::uint8_t quantized(double deviation) {
  return static_cast<std::uint8_t>(std::min(255.0, deviation * ColorTable::per_deviation));
}

}  // namespace

ColorTable::ColorTable(const ColorModel& model) {
  // Colours at the corners of the table's cells.
  constexpr int corners = side + 1;
  std::vector<Entry> lattice;
  for (int b = 0; b < corners; ++b) {
    for (int g = 0; g < corners; ++g) {
      for (int r = 0; r < corners; ++r) {
        const Eigen::Vector3d color(std::min(b * step, 255), std::min(g * step, 255),
                                    std::min(r * step, 255));
        const ColorDeviation deviation = model.deviation(color);
        lattice.push_back({quantized(std::max(deviation.tint, deviation.value)),
                           quantized(std::max(deviation.tint, deviation.value / 2))});
      }
    }
  }
  for (int b = 0; b < side; ++b) {
    for (int g = 0; g < side; ++g) {
      for (int r = 0; r < side; ++r) {
        Entry least{255, 255};
        for (int corner = 0; corner < 8; ++corner) {
          const int at =
              ((b + corner / 4) * corners + g + corner / 2 % 2) * corners + r + corner % 2;
          const Entry& here = lattice[static_cast<std::size_t>(at)];
          least.core = std::min(least.core, here.core);
          least.neighbor = std::min(least.neighbor, here.neighbor);
        }
        entries_.push_back(least);
      }
    }
  }
}

}  // namespace diminish
