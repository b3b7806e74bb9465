#pragma once

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "estimate/plane_sweep/candidate_choice.h"
#include "estimate/plane_sweep/gradient_refinement.h"
#include "estimate/plane_sweep/plane_smoothing.h"
#include "estimate/plane_sweep/semi_global.h"
#include "estimate/plane_sweep/sweep_geometry.h"
#include "estimate/plane_sweep/turned_view.h"

namespace diminish {

/// Depth from two pictures by a plane sweep (Collins 1996; Gallup et al. 2007): planes parallel to
/// the reference camera's picture are swept through the scene; where both cameras see the same on a
/// plane, there is a surface.
class PlaneSweep {
 public:
  /// view: the pinhole of the depth image, without lens distortion.
  explicit PlaneSweep(const Intrinsics& view) : view_(view) {}

  struct Range {
    double nearest_m, farthest_m;
  };
  /// part: of the depth image. other_from_reference: between the cameras' frames. inverse_depth: of
  /// the depth image's size; 1/m, 0 where unknown; unspecified outside `swept()`. Cost: 1.5 ns per
  /// plane and four pixels, and 20 ns per pixel, shared by threads.
  void sweep(const GreyPicture& reference, const GreyPicture& other,
             const RigidTransform& other_from_reference, const Range& range, const Rect& part,
             Image<float>& inverse_depth);

  /// The part of the depth image that was swept; its sides are even.
  const Rect& swept() const { return reference_.window; }
  const SweepPlanes& planes() const { return planes_; }
  /// What a pixel of the other camera's view is worth in the middle of the range, 1/m.
  float step_of_pixel() const { return planes_.step / 2; }

 private:
  void find_nothing(Image<float>& inverse_depth);
  void refine(const Parallax& parallax);

  Intrinsics view_;
  SweepPlanes planes_;
  TurnedView reference_, other_, small_reference_, small_other_;
  Image<std::uint32_t> reference_census_, other_census_, small_reference_census_,
      small_other_census_;
  SemiGlobalMatching matching_;
  CandidateChoice choice_;
  PlaneSmoothing smoothing_;
  GradientRefinement gradient_;
  Image<float> coarse_, fine_;
};

}  // namespace diminish
