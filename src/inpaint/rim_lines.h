#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/joined_runs.h"
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

  template <class Visit>
  void for_each_on_ring(int y, const Rect& box, const Visit& visit);
  Eigen::Vector2f gradient(int x, int y) const;
  float level(const Eigen::Vector2f& at) const;
  bool is_hidden(const Eigen::Vector2f& at) const;
  bool is_inside(const Eigen::Vector2f& at) const;
  bool start(int x, int y, Track& track);
  bool follow(Track& track);
  bool collect_profile(ImageView<Bgr> picture, RimLine& line) const;
  bool is_known(const RimLine& line) const;

  const Mask* occlusion_ = nullptr;
  Rect part_;         ///< of the picture, around the objects
  BlurredGrey grey_;  ///< of `part_`
  MaskRuns mask_runs_;
  JoinedRuns near_, around_;  ///< of a row
  std::vector<RimLine> lines_;
};

}  // namespace diminish
