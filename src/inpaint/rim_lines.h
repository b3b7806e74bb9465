#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "inpaint/blurred_grey.h"

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

/// Finds the straight edges that run into the objects' mask.
class RimLines {
 public:
  static constexpr std::size_t most = 48;

  /// Finds the lines. Reads nothing inside the mask. objects: the mask's box. Cost: that of
  /// blurring all within 166 pixels.
  void find(ImageView<Bgr> picture, const Mask& occlusion, const Rect& objects);
  /// The strongest first.
  const std::vector<RimLine>& lines() const { return lines_; }

 private:
  struct Track;

  void find_ring(const Rect& box);
  Eigen::Vector2f gradient(int x, int y) const;
  float level(const Eigen::Vector2f& at) const;
  bool is_hidden(const Eigen::Vector2f& at) const;
  bool is_inside(const Eigen::Vector2f& at) const;
  bool start(int x, int y, Track& track);
  bool follow(Track& track);
  bool collect_profile(ImageView<Bgr> picture, RimLine& line) const;
  bool is_known(const RimLine& line) const;

  const Mask* occlusion_ = nullptr;
  Rect part_;                  ///< of the picture, around the objects
  BlurredGrey grey_;           ///< of `part_`
  Mask hidden_, near_, ring_;  ///< of the box around the mask
  Mask scratch_;
  std::vector<RimLine> lines_;
};

}  // namespace diminish
