#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/even_color.h"
#include "diminish/image.h"

namespace diminish {

/// The depth pixels at which a camera's scene is sampled: a regular grid.
struct SampleGrid {
  /// For each camera.
  static constexpr int usual_samples = 4000;
  /// How far around a pixel `is_on_surface` looks.
  static constexpr int reach = 2;

  int width = 0, height = 0;  ///< of the depth image
  int step = 1;               ///< the distance between samples, in depth pixels

  SampleGrid() = default;
  SampleGrid(int width_, int height_, int samples = usual_samples)
      : width(width_),
        height(height_),
        step(std::max(1, static_cast<int>(std::lround(
                             std::sqrt(static_cast<double>(width_) * height_ / samples))))) {}

  int columns() const { return count(width); }
  int rows() const { return count(height); }
  /// In the depth image.
  int column(int i) const { return first() + i * step; }
  int row(int i) const { return first() + i * step; }
  /// The first row of the grid at or below a row of the depth image.
  int row_from(int y) const { return std::max(0, (y - first() + step - 1) / step); }

 private:
  int first() const { return reach + step / 2; }
  int count(int size) const {
    const int last = size - reach - 1;
    return last < first() ? 0 : (last - first()) / step + 1;
  }
};

/// Whether a depth pixel of the grid lies on a surface: one that is further than 3 % from its
/// neighbours lies on an edge or on a surface seen edge-on.
inline bool is_on_surface(ImageView<std::uint16_t> depth, int column, int row) {
  constexpr float edge = 0.03F;
  constexpr int reach = SampleGrid::reach;
  const auto own = static_cast<float>(depth(column, row));
  for (const auto& [dx, dy] : {std::pair{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) {
    const auto other = static_cast<float>(depth(column + dx, row + dy));
    if (!(std::abs(other - own) <= edge * own)) return false;
  }
  return own > 0;
}

/// The colour of a sample: its neighbourhood's mean, rounded.
struct SampleColor {
  Bgr color;
  bool even = false;
};

/// u, v: in the colour image. False too near to its border.
inline bool find_sample_color(ImageView<Bgr> image, float u, float v, SampleColor& found) {
  constexpr int rim = even_color_reach_px;
  const int x = static_cast<int>(std::lrint(u));
  const int y = static_cast<int>(std::lrint(v));
  if (x < rim || x >= image.width() - rim || y < rim || y >= image.height() - rim) return false;
  const EvenColor color = even_color(image, x, y);
  const auto level = [&](int c) {
    return static_cast<std::uint8_t>(std::lrint(color.channels[c]));
  };
  found = {{level(0), level(1), level(2)}, color.even};
  return true;
}

}  // namespace diminish
