#pragma once

#include <cstdint>
#include <vector>

#include "core/rows.h"
#include "diminish/image.h"
#include "estimate/plane_sweep/sweep_geometry.h"

namespace diminish {

/// Two views for semi-global matching: the reference, and another that is turned like it.
struct MatchedViews {
  const Image<std::uint8_t>& reference;          ///< brightness
  const Image<std::uint32_t>& reference_census;  ///< of the same size
  const Image<std::uint32_t>& other_census;
  Parallax parallax;  ///< from a pixel of `reference` to one of `other_census`
};

/// For each pixel of a view, the plane whose point another view shows alike, where neighbours
/// tend to lie on the same plane: semi-global matching (Hirschmueller 2008) along four directions,
/// over planes parallel to the picture instead of a rectified pair's disparities.
class SemiGlobalMatching {
 public:
  /// Without a plane.
  static constexpr float none = -1;

  /// found: for each pixel of the reference the plane's number, between whole ones by a parabola
  /// through the costs; `none` where no plane is clearly better than all others. Cost: 1.5 ns per
  /// pixel and plane, shared by threads. Memory: 2 bytes per pixel and plane.
  void match(const MatchedViews& views, const SweepPlanes& planes, Image<float>& found);

 private:
  /// Where the planes' points lie in a row of the other view.
  struct RowOfPlanes {
    std::vector<float> scale, shift;
    std::vector<std::int32_t> row;  ///< of the first pixel of the other view's row
  };
  /// Memory of one task.
  struct Scratch {
    RowOfPlanes planes;
    std::vector<std::uint8_t> paths;
  };

  void prepare(const MatchedViews& views, const SweepPlanes& planes);
  void follow_rows(const MatchedViews& views, int count);
  void match_row(const MatchedViews& views, int count, int y, RowOfPlanes& planes);
  void follow_rows_together(const MatchedViews& views, int y, int rows, Scratch& scratch);
  void follow_columns(const MatchedViews& views, int count, Image<float>& found);
  std::size_t at(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(pitch_);
  }

  int width_ = 0;
  int pitch_ = 0;                               ///< bytes of a pixel's planes
  std::vector<float> scales_, inverse_depths_;  ///< of each plane
  std::vector<std::uint8_t> costs_, sums_;
  Scratch scratch_[most_bands];
  std::vector<Scratch> column_scratch_;  ///< by columns that are followed together
};

}  // namespace diminish
