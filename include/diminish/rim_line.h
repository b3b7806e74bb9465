#pragma once

#include <Eigen/Core>
#include <array>

namespace diminish {

/// A straight edge that runs into the objects' mask, as the colour camera sees it outside.
struct RimLine {
  /// Colours are known this far to each side.
  static constexpr int half_width = 8;
  static constexpr int profile_size = 2 * half_width + 1;

  Eigen::Vector2f entry;    ///< where it enters the mask, pixels
  Eigen::Vector2f outward;  ///< unit vector along the line, away from the mask
  Eigen::Vector2f normal;   ///< unit vector across it, towards its bright side
  float contrast;           ///< grey levels per pixel
  int length;               ///< how far it is straight outside the mask, pixels
  /// The mean colours at entry + (i - half_width) normal, taken along the line.
  std::array<Eigen::Array3f, profile_size> profile;

  float strength() const { return contrast * static_cast<float>(length); }
};

}  // namespace diminish
