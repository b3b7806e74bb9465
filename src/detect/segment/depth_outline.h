#pragma once

#include <opencv2/core.hpp>

#include "depth/color_places.h"
#include "diminish/image.h"
#include "diminish/rig.h"
#include "geometry/ray_table.h"

namespace diminish {

/// Networks' outlines are some pixels off; where an object stands free, an RGB-D camera's depth
/// knows better. Near the outline, each depth pixel goes to the side whose depth is more like its
/// own, where the two sides differ.
class DepthOutline {
 public:
  explicit DepthOutline(const RgbdCamera& camera);

  /// color: what the network found in the RGB-D camera's colour image; its outline is moved.
  /// error_px: by how much it may be wrong, in pixels of the colour image. threshold_m: the step in
  /// depth that separates two things.
  void refine(ImageView<std::uint16_t> depth, float error_px, float threshold_m, Mask& color);

 private:
  /// Of each depth pixel: its colour pixel, and whether that is in the mask.
  void look_up(ImageView<std::uint16_t> depth, const Mask& color);
  /// The nearest measured pixel of those that `sources` is 0 in: for each pixel its depth.
  void spread(const cv::Mat& sources, cv::Mat& nearest_m);
  /// Of one depth pixel, in the colour mask.
  void paint(int x, int y, std::uint8_t value, Mask& color) const;

  std::shared_ptr<const RayTable> rays_;
  ColorPlaces places_;
  float unit_m_;
  double color_px_;     ///< of the colour image, along a pixel of the depth image
  cv::Size footprint_;  ///< of a pixel of the depth image, in the colour image
  std::vector<std::int32_t> columns_, lines_;
  cv::Mat depth_m_;      ///< 0: none
  cv::Mat in_mask_;      ///< 255: in the mask
  cv::Mat core_, sure_;  ///< 255: surely on the object; surely beside it
  cv::Mat core_m_, rest_m_;
  cv::Mat distance_, labels_, kernel_;
  std::vector<float> by_label_;
};

}  // namespace diminish
