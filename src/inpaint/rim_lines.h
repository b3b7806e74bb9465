#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/rim_line.h"
#include "inpaint/blurred_grey.h"

namespace diminish {

/// Finds the straight edges that run into the objects' mask.
class RimLines {
 public:
  static constexpr std::size_t most = 48;

  /// Finds the lines. Reads nothing inside the mask. objects: the mask's box. Cost: that of
  /// blurring all within 166 pixels.
  void find(ImageView<Bgr> picture, const Mask& occlusion, const Rect& objects);
  void clear() { lines_.clear(); }
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
