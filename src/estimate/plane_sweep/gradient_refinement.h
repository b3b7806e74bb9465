#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/rows.h"
#include "estimate/plane_sweep/fine_views.h"

namespace diminish {

/// Moves each pixel's inverse depth so that both views show the same brightness around it (Lucas &
/// Kanade 1981, along the epipolar line). Differences in brightness between the cameras do no harm.
class GradientRefinement {
 public:
  /// One step of Gauss and Newton. step: of inverse depth, a pixel's worth; nothing moves further.
  /// inverse_depth: 0 where unknown. Cost: 5 ns per pixel, shared by threads.
  void move(const FineViews& views, float step, Image<float>& inverse_depth);

 private:
  /// How many pixels count, differences, slopes, products, squares
  static constexpr std::size_t terms = 5;
  /// What a band's window adds up to, column by column and in the whole square.
  struct Scratch {
    std::array<std::vector<std::int32_t>, terms> columns, sums;
  };

  static void add_row(const std::int16_t* differences, const std::int16_t* slopes, int count,
                      std::int32_t sign, Scratch& scratch);
  static void move_row(const Scratch& scratch, int count, float step, float* inverse_depths);

  Image<std::int16_t> difference_, slope_;
  Scratch scratch_[most_bands];
};

}  // namespace diminish
