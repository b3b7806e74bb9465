#pragma once

#include <array>
#include <optional>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/intrinsics.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/scene_samples.h"
#include "geometry/projection.h"
#include "pose/direct_alignment.h"

namespace diminish {

struct PoseRefinementSettings {
  /// About what the picture is shrunk to, to blur what is misplaced by a few pixels into one
  /// another.
  int small_width = 320;
  float last_step = 1e-4F;    ///< smaller ones end the iteration, in metres and radians
  bool extrapolates = false;  ///< gets there in fewer steps, by going further than each says
  int coarser = 0;            ///< pictures, each half as wide as the next, that are aligned before
  float reach = 1;            ///< how many times as far off as a marker's the pose may be
};

/// Corrects the colour camera's pose by what it and the RGB-D cameras see in this frame: one
/// nearly frontal marker leaves half a degree open, which moves the background by many pixels.
///
/// Direct alignment: brightness at the samples' projections must equal, but for gain and offset,
/// what the RGB-D camera saw there (Gauss-Newton on 6 degrees of freedom with robust weights, as in
/// Kerl, Sturm & Cremers 2013), in shrunk pictures, the
/// smallest first. The pose that was measured is held to within its uncertainty.
class PoseRefinement {
 public:
  static constexpr int usual_width = PoseRefinementSettings{}.small_width;
  /// Smaller steps move no pixel by a tenth.
  static constexpr float usual_last_step = PoseRefinementSettings{}.last_step;
  /// From 80 pixels' width on, an error of 16 pixels in 1280 is one of a pixel.
  static constexpr int usual_coarser = 2;

  explicit PoseRefinement(const Intrinsics& color, const PoseRefinementSettings& settings = {});

  /// The spacings of neighbourhood_brightness that the usual refinement looks at.
  static std::array<int, 1 + usual_coarser> usual_spacings_px(const Intrinsics& color);

  /// Returns how the colour camera's frame moves: color_from_measured_color. Nothing where no
  /// correction is taken: it must explain the picture better, and be small. Cost: about 0.2 us a
  /// sample that the colour camera sees.
  std::optional<RigidTransform> refine(const FrameSet& frame, const Mask& occlusion,
                                       const SceneSamples& scene);

  /// How badly the picture is explained by the pose as it was measured, and by the best one near
  /// it.
  struct Costs {
    float measured = 0, refined = 0;
  };
  /// Of the last `refine`; nothing if it saw too little.
  const std::optional<Costs>& costs() const { return costs_; }
  /// What they would be if the colour camera had this lens, with which its pose would be measured
  /// elsewhere: other_from_measured_color. The frame and the mask that were refined must still be
  /// there. Cost: a fifteenth of refine's; refined, a third.
  std::optional<float> measured_cost_with(const Projection& other, const RigidTransform& moved);
  std::optional<float> refined_cost_with(const Projection& other, const RigidTransform& moved);

  /// Takes poses and samples to the corrected frame.
  void apply(const RigidTransform& correction, Poses& poses, SceneSamples& samples) const;

 private:
  float reach_;
  DirectAlignment fine_;
  DirectAlignment::Estimate estimate_;  ///< of the last `refine`
  std::optional<Costs> costs_;
  std::vector<DirectAlignment> coarser_;  ///< the smallest picture first
  std::vector<std::uint8_t> has_begun_;   ///< which of them
  Projection projection_;
};

}  // namespace diminish
