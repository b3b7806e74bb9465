#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/shrunk_picture.h"
#include "diminish/frame_set.h"
#include "diminish/scene_samples.h"
#include "geometry/projection.h"
#include "geometry/rigid_least_squares.h"

namespace diminish {

/// Aligns the colour camera's picture, shrunk by one factor, with what the RGB-D cameras see:
/// Gauss-Newton on the 6 degrees of freedom of the colour camera's pose, with robust weights, and a
/// gain and an offset of each RGB-D camera (PoseRefinement). Use: begin, then iterate.
class DirectAlignment {
 public:
  /// A shift (metres), then a rotation (radians).
  using Twist = Eigen::Matrix<float, 6, 1>;

  struct Settings {
    int shrinkage;
    std::size_t most_points;
    float last_step;    ///< smaller ones end the iteration, in metres and radians
    bool extrapolates;  ///< gets there in fewer steps, by going further than each says

    /// Between the pixels of an RGB-D camera that are compared with one of the small picture.
    int spacing_px() const { return shrinkage / 2; }
  };
  struct Estimate {
    RigidTransform correction;
    Twist twist = Twist::Zero();  ///< the sum of the steps
    float cost = 0;
  };

  /// deviations: the measured pose's standard deviations.
  DirectAlignment(const Intrinsics& color, const Settings& settings, const Twist& deviations)
      : projection_(Lens(color)), level_(settings), deviations_(deviations) {}

  /// Shrinks the picture and collects points. False if the picture is too small. Picture and
  /// occlusion must outlive the iterations.
  bool begin(const FrameSet& frame, const Mask& occlusion, const SceneSamples& scene);
  /// What follows is by another lens. The points stay those of `begin`.
  void change_lens(const Projection& color) { projection_ = color; }
  /// Betters the estimate, and finds its cost. False if the colour camera sees too few points.
  bool iterate(int iterations, Estimate& estimate);

 private:
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
  using Equations = NormalEquations<float>;
  static constexpr std::size_t most_sources = 256;

  /// Robust weights and gains follow slowly: where steps go on in the same direction, as far as
  /// they would go in the end.
  static Twist further(const Twist& step, const Twist& last);
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
  float cost() const;

  Projection projection_;
  Settings level_;
  Twist deviations_;
  ShrunkPicture small_;
  std::vector<Points> points_;
  std::vector<float> magnitudes_;
  std::vector<Line> lines_;  ///< by source
};

}  // namespace diminish
