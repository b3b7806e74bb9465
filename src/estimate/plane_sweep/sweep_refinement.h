#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "estimate/plane_sweep/plane_smoothing.h"
#include "estimate/plane_sweep/sweep_geometry.h"

namespace diminish {

/// Two views at twice the resolution of those that were matched.
struct FineViews {
  const Image<std::uint8_t>& reference;
  const Image<std::uint32_t>& reference_census;
  const Image<std::uint8_t>& other;
  const Image<std::uint32_t>& other_census;
  Parallax parallax;
};

/// Makes planes found at half the resolution finer than planes and pixels are. Each pixel chooses
/// among the planes of the nearest four pixels of the coarse view by the census around it; then its
/// inverse depth follows the gradient of brightness (Lucas & Kanade 1981, in one dimension).
class SweepRefinement {
 public:
  /// coarse: planes by number, SemiGlobalMatching::none where unknown. inverse_depth: of the
  /// reference view's size, 1/m; 0 where unknown. Cost: 15 ns per pixel, shared by threads.
  void refine(const FineViews& views, const SweepPlanes& planes, const Image<float>& coarse,
              Image<float>& inverse_depth);

 private:
  void choose(const FineViews& views, const SweepPlanes& planes, const Image<float>& coarse,
              Image<float>& inverse_depth);
  void follow_gradient(const FineViews& views, float smallest_step, Image<float>& inverse_depth);

  std::array<Image<std::uint8_t>, 4> costs_;  ///< of each candidate
  Image<float> difference_, slope_;
  PlaneSmoothing smoothing_;
};

}  // namespace diminish
