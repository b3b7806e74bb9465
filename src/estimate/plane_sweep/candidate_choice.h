#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/rows.h"
#include "estimate/plane_sweep/fine_views.h"

namespace diminish {

/// Gives planes that were found at half the resolution to the pixels of the whole one: each chooses
/// among the planes of the four nearest coarse pixels by the census in a square around it.
class CandidateChoice {
 public:
  /// coarse: planes by number, SemiGlobalMatching::none where unknown. inverse_depth: 1/m, 0 where
  /// unknown; it gets the reference view's size. Cost: 8 ns per pixel, shared by threads.
  void choose(const FineViews& views, const SweepPlanes& planes, const Image<float>& coarse,
              Image<float>& inverse_depth);

 private:
  static constexpr std::size_t candidates = 4;
  /// Memory of a band.
  struct Scratch {
    std::vector<float> inverse_depths;
    std::array<std::vector<float>, 2> coarse_rows;  ///< likewise
    std::array<std::vector<std::uint16_t>, candidates> columns, sums;
  };

  std::array<Image<std::uint8_t>, candidates> costs_;
  std::array<std::vector<int>, 2> columns_;  ///< of the coarse pixels beside each fine one
  Scratch scratch_[most_bands];
};

}  // namespace diminish
