#include "pose/marker_code.h"

#include <algorithm>
#include <cmath>

#include "geometry/homography.h"

namespace diminish {
namespace {

/// The share of the errors that a dictionary could correct which is corrected; OpenCV's default.
constexpr double correction_rate = 0.6;
/// The share of the border's cells that may be light.
constexpr double border_errors = 0.2;
/// Between the mean of the light cells and that of the dark ones.
constexpr float min_contrast = 20;

}  // namespace

MarkerCode::MarkerCode(const MarkerDictionary& dictionary)
    : bits_(dictionary.side),
      max_errors_(static_cast<int>(dictionary.correctable_cells * correction_rate)),
      codes_(dictionary.codes) {}

std::optional<MarkerCode::Reading> MarkerCode::read(
    ImageView<Bgr> image, const std::array<Eigen::Vector2d, 4>& corners) const {
  const Eigen::Matrix3d image_from_unit = homography_of_unit_square(corners);
  const int n = modules();
  std::array<float, max_modules * max_modules> cells{};
  float least = 255;
  float most = 0;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      // Samples the cell's middle half at 3x3 points.
      int sum = 0;
      for (int sample = 0; sample < 9; ++sample) {
        const double u = (column + 0.5 + 0.2 * (sample % 3 - 1)) / n;
        const double v = (row + 0.5 + 0.2 * (sample / 3 - 1)) / n;
        const Eigen::Vector3d at = image_from_unit * Eigen::Vector3d(u, v, 1);
        const int x = static_cast<int>(std::lrint(at.x() / at.z()));
        const int y = static_cast<int>(std::lrint(at.y() / at.z()));
        if (!image.bounds().contains(x, y)) return std::nullopt;
        sum += image(x, y).g;
      }
      const float mean = static_cast<float>(sum) / 9;
      cells[static_cast<std::size_t>(row * n + column)] = mean;
      least = std::min(least, mean);
      most = std::max(most, mean);
    }
  }
  if (most - least < min_contrast) return std::nullopt;
  // Halfway between the means of the dark and the light cells.
  float limit = (least + most) / 2;
  for (int pass = 0; pass < 2; ++pass) {
    float dark = 0;
    float light = 0;
    int light_count = 0;
    for (int i = 0; i < n * n; ++i) {
      const float value = cells[static_cast<std::size_t>(i)];
      (value > limit ? light : dark) += value;
      light_count += value > limit ? 1 : 0;
    }
    if (light_count == 0 || light_count == n * n) return std::nullopt;
    limit =
        (dark / static_cast<float>(n * n - light_count) + light / static_cast<float>(light_count)) /
        2;
  }

  const auto is_light = [&](int row, int column) {
    return cells[static_cast<std::size_t>(row * n + column)] > limit;
  };
  int light_border = 0;
  for (int i = 0; i + 1 < n; ++i) {
    light_border +=
        is_light(0, i) + is_light(i, n - 1) + is_light(n - 1, n - 1 - i) + is_light(n - 1 - i, 0);
  }
  if (light_border > border_errors * 4 * (n - 1)) return std::nullopt;

  for (int turn = 0; turn < 4; ++turn) {
    Bits seen;
    for (int row = 0; row < bits_; ++row) {
      for (int column = 0; column < bits_; ++column) {
        // The marker with corner `turn` as its top left.
        int r = row;
        int c = column;
        for (int i = 0; i < turn; ++i) {
          const int turned = c;
          c = bits_ - 1 - r;
          r = turned;
        }
        seen[static_cast<std::size_t>(row * bits_ + column)] = is_light(r + 1, c + 1);
      }
    }
    for (std::size_t id = 0; id < codes_.size(); ++id) {
      if (static_cast<int>((codes_[id] ^ seen).count()) <= max_errors_) {
        return Reading{static_cast<int>(id), turn};
      }
    }
  }
  return std::nullopt;
}

}  // namespace diminish
