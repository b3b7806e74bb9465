#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bars/bar.h"
#include "bars/bar_views.h"
#include "diminish/rim_line.h"
#include "diminish/surfaces.h"

namespace diminish {

/// Finds bars that depth sensors do not see, such as steel pipes. Two parallel edges that run into
/// the mask are the sides of one if, at some distance in front of the plane behind them, an RGB-D
/// camera has no depth between them and has depth beside them, and its picture shows both edges.
/// One that an earlier frame showed needs no edges in the user's picture.
class BarSearch {
 public:
  struct Input {
    std::span<const RimLine> lines;
    const BarViews& views;
    const std::vector<BackgroundPlane>& planes;
    const Surfaces& surfaces;
    const Mask& occlusion;       ///< of the colour camera
    std::span<const Bar> known;  ///< of earlier frames: looked for where they were
  };
  /// The surest first. Deterministic. Cost: 20 us for each pair of edges that may be a bar.
  void find(const Input& input);
  const std::vector<Bar>& bars() const { return bars_; }
  void clear() { bars_.clear(); }

 private:
  struct Pair {
    Bar bar;                     ///< at no distance yet
    float outer_end, inner_end;  ///< what is looked at, along it
    BackgroundPlane behind;      ///< in front of which it is looked for
    bool is_known = false;       ///< in an earlier frame, about there
  };
  static std::optional<Pair> pair_of(const Input& input, const RimLine& a, const RimLine& b);
  /// Adds what the pair may be to `found`.
  static void judge(const Input& input, const Pair& pair, std::vector<Bar>& found);

  std::vector<Pair> pairs_;
  std::vector<std::vector<Bar>> found_by_pair_;  ///< there may be more
  std::vector<Bar> found_, bars_;
};

/// Whether both lie over each other in the user's picture, or hide the same from an RGB-D camera,
/// which then has one hole for both.
bool exclude_each_other(const BarViews& views, const Bar& bar, const Bar& other);

/// Whether it is but the space between two others, which have its edges and together are surer.
bool is_between(const Bar& bar, std::span<const Bar> others);

}  // namespace diminish
