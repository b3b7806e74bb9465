#pragma once

#include <cstdint>
#include <vector>

#include "depth/discontinuity.h"
#include "depth/visible_blocks.h"
#include "diminish/color_map.h"
#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "render/vertex_row.h"

namespace diminish {

/// What an RGB-D camera sees on a line of sight of the colour camera.
struct SeenSurface {
  float depth_m = 0;  ///< z in the colour camera's frame; 0: nothing
  Bgr color;          ///< mapped to the colour camera's
  std::uint8_t source = 0;
};

/// The first and the last surface that any RGB-D camera sees on each line of sight of the colour
/// camera, objects included, in a picture made smaller. One camera sees both where it looks past
/// the first.
struct SeenLayers {
  Image<SeenSurface> nearest, farthest;
};

/// A depth pixel in the small picture.
struct LayerVertex {
  float x = 0, y = 0;     ///< pixels
  float depth_m = 0;      ///< z in the colour camera's frame; 0: none
  float own_depth_m = 0;  ///< z in the depth sensor's frame
  float u = 0, v = 0;     ///< place in the RGB-D camera's colour image
};

/// The pixels [left, right) x [top, bottom) between four vertices.
struct DrawnCell {
  int left = 0, right = 0, top = 0, bottom = 0;
  SeenSurface surface;
};

/// Draws SeenLayers. Coarse: each cell of four depth pixels that SDCT joins (sdct.h) fills its
/// bounding box.
class SeenLayersDrawer {
 public:
  explicit SeenLayersDrawer(const Rig& rig);

  /// The small picture is about this wide.
  static constexpr int usual_width = 320;
  /// How many of the colour camera's pixels are one of the small picture's, along a side.
  int shrinkage() const { return shrinkage_; }

  /// Cost: about 20 ns a depth pixel that is used.
  void draw(const FrameSet& frame, const Poses& poses, ColorMapsBySource maps,
            const sdct::Threshold& threshold, SeenLayers& layers);

  /// Those of the last drawing; empty where an RGB-D camera took no part. One for every
  /// `step(camera)`-th column of every such row.
  const Image<LayerVertex>& vertices(std::size_t camera) const { return cameras_[camera].vertices; }
  int step(std::size_t camera) const { return cameras_[camera].step; }

 private:
  struct Camera {
    int step;  ///< between the depth pixels that are used
    VertexRows rows;
    VisibleBlocks visible;
    Mask no_depth_mask, no_color_mask;
    Image<std::uint16_t> depth = {};
    VertexRow row[most_bands] = {};
    Image<LayerVertex> vertices = {};
    std::vector<DrawnCell> cells[most_bands] = {};
  };
  void find_vertices(const RgbdFrame& images, const RigidTransform& color_from_depth,
                     Camera& camera) const;
  void find_cells(ImageView<Bgr> picture, const ColorMap& map, std::uint8_t source,
                  const sdct::Threshold& threshold, Camera& camera) const;

  Rect color_bounds_;
  int width_, height_, shrinkage_;
  std::vector<Camera> cameras_;
};

}  // namespace diminish
