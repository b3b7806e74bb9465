#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/reconstruction.h"

namespace diminish {

/// How much lighter the user's camera saw surfaces earlier than the RGB-D cameras see them now,
/// after their colour maps: the objects to remove take light from what is behind them, and a map is
/// not right everywhere. Known where both show the same surface; what is seen only now, beside it,
/// is brought to the same light.
class LightRatio {
 public:
  /// A surface at a pixel of the picture; channels in levels.
  struct Pair {
    int x, y;
    Eigen::Array3f now, then;
  };
  /// A pixel of so many, and a row of so many, tells enough.
  static constexpr int step = 4;

  /// part: of the picture, with all pairs. Begins without pairs.
  void begin(const Rect& part);
  void add(std::span<const Pair> pairs);
  /// Call it after the last pair.
  void solve();
  /// Scales the RGB-D cameras' colours inside the objects' mask, around the pairs. Cost: 10 ns a
  /// pixel.
  void apply(const Mask& objects, Reconstruction& reconstruction) const;

 private:
  using Channels = Eigen::Array4f;  ///< the fourth means nothing

  struct Cell {
    Channels now = Channels::Zero();
    Channels then = Channels::Zero();
  };
  /// Blurs along rows (1) or columns (the width).
  void blur(int stride);

  Rect part_;  ///< cell (x, y) is around its pixel (x, y) * node_px
  int width_ = 0, height_ = 0;
  bool any_ = false;
  std::vector<Cell> cells_, blurred_;
  std::vector<Channels> ratios_;
};

}  // namespace diminish
