#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/intrinsics.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"

namespace diminish {

/// Corrects the colour camera's pose by what it and the RGB-D cameras see in this frame: one
/// nearly frontal marker leaves half a degree open, which moves the background by many pixels.
///
/// Direct alignment: brightness at the samples' projections must equal, but for gain and offset,
/// what the RGB-D camera saw there (Gauss-Newton on 6 degrees of freedom with robust weights, as in
/// Kerl, Sturm & Cremers 2013), in a picture of a quarter of the size. The pose that the markers
/// gave is held to within its uncertainty.
class PoseRefinement {
 public:
  explicit PoseRefinement(const Intrinsics& color);

  /// Moves `samples` and the poses. Returns whether the correction was taken: it must explain the
  /// picture better, and be small. Cost: one pass over the picture, and 0.5 us a sample.
  bool refine(const FrameSet& frame, const Mask& occlusion, std::vector<SceneSample>& samples,
              Poses& poses);

 private:
  using Pose = Eigen::Matrix<double, 6, 1>;

  struct Point {
    Eigen::Vector3f point_m;
    float brightness;  ///< what the RGB-D camera saw
    std::uint8_t source;
  };

  void shrink(const Image<Bgr>& image);
  void collect(const FrameSet& frame, const std::vector<SceneSample>& samples);
  Lens lens_;
  Image<float> small_;
  std::vector<Point> points_;
};

}  // namespace diminish
