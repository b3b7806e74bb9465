#include "memory/light_ratio.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/rows.h"
#include "diminish/diminished_frame.h"

namespace diminish {
namespace {

constexpr int node_px = 16;
/// Cells around which others say something.
constexpr int light_reach = 2;
/// A binomial.
constexpr std::array<float, 2 * light_reach + 1> weights{1 / 6.F, 4 / 6.F, 1, 4 / 6.F, 1 / 6.F};

/// A channel that is nearly black or white does not say how much light there was.
bool is_exposed(const Eigen::Array3f& levels) {
  return (levels >= 6).all() && (levels <= 245).all();
}

std::uint8_t scaled(std::uint8_t level, float ratio) {
  return static_cast<std::uint8_t>(std::min(255.F, ratio * static_cast<float>(level) + 0.5F));
}

}  // namespace

void LightRatio::begin(const Rect& part) {
  part_ = grow(part, light_reach * node_px);
  width_ = part_.width / node_px + 2;
  height_ = part_.height / node_px + 2;
  cells_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), Cell());
  any_ = false;
}

void LightRatio::add(std::span<const Pair> pairs) {
  for (const Pair& pair : pairs) {
    if (!is_exposed(pair.now) || !is_exposed(pair.then)) continue;
    const int x = (pair.x - part_.x + node_px / 2) / node_px;
    const int y = (pair.y - part_.y + node_px / 2) / node_px;
    Cell& cell = cells_[static_cast<std::size_t>(y * width_ + x)];
    cell.now.head<3>() += pair.now;
    cell.then.head<3>() += pair.then;
    any_ = true;
  }
}

void LightRatio::blur(int stride) {
  const int count = width_ * height_;
  const int length = stride == 1 ? width_ : height_;
  blurred_.resize(cells_.size());
  for (int i = 0; i < count; ++i) {
    const int place = stride == 1 ? i % width_ : i / width_;
    Cell sum;
    for (int k = std::max(-light_reach, -place); k <= std::min(light_reach, length - 1 - place);
         ++k) {
      const Cell& other = cells_[static_cast<std::size_t>(i + k * stride)];
      const float weight = weights[static_cast<std::size_t>(k + light_reach)];
      sum.now += weight * other.now;
      sum.then += weight * other.then;
    }
    blurred_[static_cast<std::size_t>(i)] = sum;
  }
  std::swap(cells_, blurred_);
}

void LightRatio::solve() {
  if (!any_) return;
  blur(1);
  blur(width_);
  // A few pairs say little, and less where it is dark.
  constexpr float few = 8 * 128;
  constexpr float most = 2;
  ratios_.resize(cells_.size());
  std::transform(cells_.begin(), cells_.end(), ratios_.begin(), [&](const Cell& cell) {
    return Channels(((cell.then + few) / (cell.now + few)).max(1 / most).min(most));
  });
}

void LightRatio::apply(const Mask& objects, Reconstruction& reconstruction) const {
  if (!any_) return;
  constexpr float invisible = 1.F / 512;
  const Rect drawn = intersect(part_, reconstruction.region);
  const bool has_second = !reconstruction.second.share.empty();
  for_rows(drawn.height, [&](Rows rows) {
    for (int y = drawn.y + rows.first; y < drawn.y + rows.last; ++y) {
      const int row = (y - part_.y) / node_px;
      const auto down = static_cast<float>((y - part_.y) % node_px) / node_px;
      const Channels* const above = ratios_.data() + row * width_;
      const auto at = [&](int column) {
        return Channels(above[column] + down * (above[column + width_] - above[column]));
      };
      const std::uint8_t* const masked = objects.row(y);
      const std::uint8_t* const source = reconstruction.source.row(y);
      for (int first = drawn.x; first < drawn.right();) {
        const int column = (first - part_.x) / node_px;
        const int node = part_.x + column * node_px;
        const int last = std::min(drawn.right(), node + node_px);
        const Channels left = at(column);
        const Channels slope = (at(column + 1) - left) / node_px;
        const bool is_same = ((left - 1).abs() < invisible).head<3>().all() &&
                             ((left + node_px * slope - 1).abs() < invisible).head<3>().all();
        for (int x = is_same ? last : first; x < last; ++x) {
          if (masked[x] == 0 || source[x] == 0 || source[x] >= provenance::witnessed) continue;
          const Channels ratio = left + static_cast<float>(x - node) * slope;
          const auto scale = [&](Bgra& color) {
            color.b = scaled(color.b, ratio[0]);
            color.g = scaled(color.g, ratio[1]);
            color.r = scaled(color.r, ratio[2]);
          };
          scale(reconstruction.color(x, y));
          if (has_second && reconstruction.second.share(x, y) != 0) {
            scale(reconstruction.second.color(x, y));
          }
        }
        first = last;
      }
    }
  });
}

}  // namespace diminish
