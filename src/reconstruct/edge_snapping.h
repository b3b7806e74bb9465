#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "diminish/image.h"
#include "diminish/rig.h"
#include "geometry/projection.h"

namespace diminish {

/// A mean of colours.
struct Bgr3 {
  float b, g, r;
};

/// Moves the edges of an RGB-D camera's depth images onto those of its colour image, which is finer
/// and sharper: a pixel beside a depth edge is given to the surface, before or behind the edge,
/// whose colour it has, and gets the depth of that surface's plane there. So do pixels without
/// depth between two surfaces. (The idea of joint bilateral upsampling, Kopf et al. 2007, as a
/// choice between two surfaces instead of a mean.) Where the surfaces' colours are alike, all
/// stays; where they have strong patterns as fine as depth pixels, edges may get worse.
class EdgeSnapping {
 public:
  explicit EdgeSnapping(const RgbdCamera& camera);

  /// What is masked is another object's, and neither read nor changed.
  struct Images {
    const Image<Bgr>& color;
    const Mask& color_mask;
    const Mask& depth_mask;
  };
  /// Changes `depth` in `part`. Cost: 1 ns a pixel of the part, 0.5 us one beside an edge.
  void snap(const Images& images, const Rect& part, Image<std::uint16_t>& depth);

 private:
  /// A neighbour's place from a pixel, and its weight.
  struct Offset {
    int x, y;
    float weight;
  };
  static const std::array<Offset, 13> offsets;
  struct Neighbour {
    const Offset* offset;
    float depth_m;
    const Bgr3* color;  ///< null: not known
  };
  using Neighbours = std::array<Neighbour, 13>;
  /// Whether two depths, in the image's units, are of two surfaces.
  struct Gap {
    float least, constant, by_square;

    explicit Gap(float unit_m);
    int is_between(int a, int b) const {  // 1 or 0: plain enough for vectors
      const auto nearer = static_cast<float>(std::min(a, b));
      const float wide = std::max(least, constant + by_square * nearer * nearer);
      return static_cast<float>(std::abs(a - b)) > wide ? 1 : 0;
    }
  };
  /// What is known of each column above a row.
  struct Columns {
    std::vector<std::uint16_t> last_depth, age;  ///< the last depth met, and rows since then
    std::vector<std::uint8_t> has_gap;
  };

  void find_edges(const Rect& part);
  void find_gaps_in_row(const std::uint16_t* depth, int count, std::uint8_t* is_edge) const;
  void find_gaps_in_columns(const Rect& part, Columns& columns);
  bool may_have_two_surfaces(const Rect& part, int x, int y) const;
  void read_colors(const Images& images, const Rect& part);
  void snap_pixel(const Images& images, int x, int y, Image<std::uint16_t>& depth) const;
  std::optional<float> choose(const Images& images, int x, int y, const Neighbours& neighbours,
                              std::size_t count) const;
  std::optional<Bgr3> color_at(const Images& images, int x, int y, float depth_m) const;

  Image<Eigen::Vector2f> rays_;
  FloatTransform to_color_;
  Projection color_;
  float unit_m_;
  Gap gap_;

  Image<std::uint16_t> depth_;       ///< as it comes
  Image<std::uint8_t> is_edge_;      ///< 1: at a depth edge
  Image<std::uint8_t> beside_edge_;  ///< 1: two surfaces may be within reach
  Image<std::uint8_t> is_read_;      ///< 1: `colors_` holds a depth pixel's colour
  Image<Bgr3> colors_;
  Columns columns_[2];  ///< of each thread
};

}  // namespace diminish
