#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/intrinsics.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "geometry/projection.h"

namespace diminish {

/// Corrects the colour camera's pose by what it and the RGB-D cameras see in this frame: one
/// nearly frontal marker leaves half a degree open, which moves the background by many pixels.
///
/// Direct alignment: brightness at the samples' projections must equal, but for gain and offset,
/// what the RGB-D camera saw there (Gauss-Newton on 6 degrees of freedom with robust weights, as in
/// Kerl, Sturm & Cremers 2013), in a picture shrunk to a width of about 320 pixels. The pose that
/// was measured is held to within its uncertainty.
class PoseRefinement {
 public:
  explicit PoseRefinement(const Intrinsics& color);

  /// Moves the reconstruction's samples and object points, and the poses. Returns whether the
  /// correction was taken: it must explain the picture better, and be small. Cost: an eighth of the
  /// picture's pixels, and 0.3 us a sample.
  bool refine(const FrameSet& frame, const Mask& occlusion, Reconstruction& reconstruction,
              Poses& poses);

 private:
  using Twist = Eigen::Matrix<float, 6, 1>;

  struct Point {
    Eigen::Vector3f point_m;
    float brightness;  ///< what the RGB-D camera saw
    std::uint8_t source;
  };
  /// A point that the colour camera sees, linearised.
  struct Row {
    Twist derivative;  ///< of what the colour camera sees there
    float brightness = 0, seen = 0, residual = 0, weight = 1;
    std::uint8_t source = 0;
  };
  struct Line {
    float gain = 1, offset = 0;
  };

  void shrink(const Image<Bgr>& image);
  void collect(const FrameSet& frame, const std::vector<SceneSample>& samples);
  void linearise(const RigidTransform& correction, const Mask& occlusion);
  /// Gain and offset of each camera, by the weights.
  void fit_lines();
  /// The residuals and their weights, by the lines; returns their scale.
  float weigh();
  void apply(const RigidTransform& correction, Reconstruction& reconstruction, Poses& poses) const;

  Intrinsics color_;
  Projection projection_;
  int shrinkage_;
  Image<float> small_;
  std::vector<Point> points_;
  std::vector<Row> rows_;
  std::vector<float> magnitudes_;
  std::vector<Line> lines_;
};

}  // namespace diminish
