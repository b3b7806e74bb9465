#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/rows.h"
#include "depth/color_places.h"
#include "depth/depth_part.h"
#include "depth/depth_rows.h"
#include "diminish/image.h"
#include "diminish/rig.h"
#include "geometry/ray_table.h"

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
    ImageView<Bgr> color;
    const Mask& color_mask;
    const Mask& depth_mask;
  };
  /// Changes `depth` in `part`. Cost: 1 ns a pixel of the part, 0.5 us one beside an edge.
  void snap(const Images& images, const DepthPart& part, Image<std::uint16_t>& depth);

 private:
  /// A neighbour's place from a pixel, its weight, and the weight's products with the place.
  struct Offset {
    int x, y;
    float weight, weight_x, weight_y, weight_xx, weight_xy, weight_yy;
  };
  static const std::array<Offset, 13> offsets;
  struct Neighbour {
    const Offset* offset;
    float depth_m, inverse_depth;
    const Bgr3* color;  ///< null: not known
  };
  using Neighbours = std::array<Neighbour, 13>;
  struct Scratch {
    std::vector<std::uint8_t> has_jump, line;
  };
  /// Some depth pixels of a row, and where they lie in the colour image.
  struct Sights {
    std::vector<int> x;
    std::vector<float> ray_x, ray_y, depth_m;
    std::vector<std::int32_t> columns, lines;

    void resize(std::size_t most) {
      constexpr std::size_t vector = 16;
      x.resize(most);
      for (auto* values : {&ray_x, &ray_y, &depth_m}) values->resize(most + vector);
      for (auto* values : {&columns, &lines}) values->resize(most + vector);
    }
  };

  void find_edges(const DepthPart& part, const Mask& mask);
  void mark_gaps(const DepthPart& part, const Rect& within, int y, bool downwards,
                 Scratch& scratch);
  void widen(const Image<std::uint8_t>& flags, const Rect& part, int by,
             Image<std::uint8_t>& wider);
  void read_colors(const Images& images, const Rect& part);
  void snap_pixel(const Images& images, int x, int y, Image<std::uint16_t>& depth) const;
  std::optional<float> choose(const Images& images, int x, int y, const Neighbours& neighbours,
                              std::size_t cut, std::size_t count) const;
  std::optional<Bgr3> color_at(const Images& images, int x, int y, float depth_m) const;

  std::shared_ptr<const RayTable> rays_;
  ColorPlaces places_;
  float unit_m_;
  depth_rows::Gap gap_;
  std::array<std::ptrdiff_t, 13> steps_;  ///< to the neighbours, in pixels of a row by row image

  Image<std::uint16_t> depth_;       ///< as it comes
  Image<std::uint16_t> free_;        ///< without what is masked
  Image<std::uint8_t> is_edge_;      ///< 1: at a depth edge
  Image<std::uint8_t> beside_edge_;  ///< 1: two surfaces may be within reach
  Image<std::uint8_t> is_read_;      ///< 1: `colors_` holds a depth pixel's colour
  Image<Bgr3> colors_;
  std::uint16_t closer_than_gap_;  ///< depths this close have no gap between them
  Scratch scratch_[most_bands];
  Sights sights_[most_bands];
};

}  // namespace diminish
