#pragma once

#include <vector>

#include "diminish/image.h"
#include "render/depth_mesh.h"
#include "render/sdct.h"

namespace diminish {

/// One RGB-D camera's view, drawn from the colour camera's viewpoint.
struct Layer {
  Image<Bgra> color;     ///< alpha 255 where a triangle was drawn
  Image<float> depth_m;  ///< z in the colour camera's frame; 0 where nothing was drawn
  /// Where `color` was looked up in the RGB-D camera's colour image; unspecified where nothing was
  /// drawn.
  Image<Eigen::Vector2f> texture;

  /// Makes `region` empty; the rest is unspecified.
  void clear(int width, int height, const Rect& region);
};

/// Bilinear interpolation, rounded to the nearest level. 0 <= u <= width - 1, 0 <= v <= height - 1.
Bgr sample_bilinear(ImageView<Bgr> image, float u, float v);

/// Draws one triangle (rules 4 and 5 of sdct.h). Looks up its colours in `texture` with
/// perspective-correct coordinates. The triangle must face forward.
void draw_triangle(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c,
                   ImageView<Bgr> texture, const Rect& region, Layer& layer);

/// Draws the mesh of `vertices` inside `region` (rules 2 and 3). Cost: one pass over the cells and
/// over the pixels of each triangle's bounding box.
void draw_mesh(const Image<MeshVertex>& vertices, ImageView<Bgr> texture,
               const sdct::Threshold& threshold, const Rect& region, Layer& layer);

}  // namespace diminish
