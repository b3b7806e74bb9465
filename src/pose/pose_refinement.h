#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/shrunk_picture.h"
#include "diminish/frame_set.h"
#include "diminish/intrinsics.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/scene_samples.h"
#include "geometry/projection.h"
#include "geometry/rigid_least_squares.h"

namespace diminish {

/// Corrects the colour camera's pose by what it and the RGB-D cameras see in this frame: one
/// nearly frontal marker leaves half a degree open, which moves the background by many pixels.
///
/// Direct alignment: brightness at the samples' projections must equal, but for gain and offset,
/// what the RGB-D camera saw there (Gauss-Newton on 6 degrees of freedom with robust weights, as in
/// Kerl, Sturm & Cremers 2013), in shrunk pictures, the
/// smallest first. The pose that was measured is held to within its uncertainty.
class PoseRefinement {
 public:
  static constexpr int usual_width = 320;
  /// Smaller steps move no pixel by a tenth.
  static constexpr float usual_last_step = 1e-4F;
  /// From 80 pixels' width on, an error of 16 pixels in 1280 is one of a pixel.
  static constexpr int usual_coarser = 2;

  /// small_width: about what the picture is shrunk to, to blur what is misplaced by a few pixels
  /// into one another. last_step: smaller ones end the iteration, in metres and radians.
  /// extrapolates: gets there in fewer steps, by going further than each says. coarser: how many
  /// pictures, each half as wide as the next, are aligned before.
  explicit PoseRefinement(const Intrinsics& color, int small_width = usual_width,
                          float last_step = usual_last_step, bool extrapolates = false,
                          int coarser = 0);

  /// Returns how the colour camera's frame moves: color_from_measured_color. Nothing where no
  /// correction is taken: it must explain the picture better, and be small. Cost: about 0.2 us a
  /// sample that the colour camera sees.
  std::optional<RigidTransform> refine(const FrameSet& frame, const Mask& occlusion,
                                       const SceneSamples& scene);

  /// Takes poses and samples to the corrected frame.
  void apply(const RigidTransform& correction, Poses& poses, SceneSamples& samples) const;

 private:
  /// A shift, then a rotation.
  using Twist = Eigen::Matrix<float, 6, 1>;

  /// Points that one RGB-D camera sees, worked on together; those after the last have no depth.
  static constexpr int lanes = 8;
  using Lanes = Eigen::Array<float, lanes, 1>;
  struct Points {
    Lanes x_m, y_m, z_m;  ///< in the colour camera's frame, as measured
    Lanes brightness;     ///< what the RGB-D camera saw
    /// What the colour camera sees there, linearised; all 0 where it sees nothing, or an object.
    Lanes is_seen, seen;
    std::array<Lanes, 6> derivative;  ///< of `seen`, by the camera's motion
    Lanes residual, weight;
    std::uint8_t source;
    int count;
  };
  struct Line {
    float gain = 1, offset = 0;
  };
  /// How one shrunk picture is aligned.
  struct Level {
    int shrinkage;
    std::size_t most_points;
    float last_step;
    bool extrapolates;
  };
  struct Estimate {
    RigidTransform correction;
    Twist twist = Twist::Zero();  ///< the sum of the steps
    float cost = 0;
  };
  struct Equations : NormalEquations<float> {
    float cost = 0;
  };

  /// Robust weights and gains follow slowly: where steps go on in the same direction, as far as
  /// they would go in the end.
  static Twist further(const Twist& step, const Twist& last);
  /// Shrinks the picture and collects points. False if the picture is too small.
  bool begin_level(const FrameSet& frame, const Mask& occlusion, const SceneSamples& scene);
  /// Betters the estimate, and finds its cost. False if the colour camera sees too few points.
  bool iterate(int iterations, Estimate& estimate);
  void collect(const FrameSet& frame, const std::vector<SceneSample>& samples);
  void add(const Eigen::Vector3f& point_m, float brightness, std::uint8_t source);
  /// Returns how many points the colour camera sees.
  std::size_t linearise(const RigidTransform& correction);
  /// Gain and offset of each camera, by the weights.
  void fit_lines();
  void find_residuals();
  /// Of the residuals.
  float find_scale();
  void weigh(float scale);
  Equations add_up() const;

  Projection projection_;
  int coarser_;
  Level fine_, level_;  ///< the last one; the one at hand
  ShrunkPicture small_;
  std::vector<Points> points_;
  std::vector<float> magnitudes_;
  std::vector<Line> lines_;
};

}  // namespace diminish
