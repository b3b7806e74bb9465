#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bars/bar_views.h"
#include "bars/shadow_surfaces.h"
#include "core/connected_regions.h"
#include "diminish/reconstruction.h"
#include "scene/color_map.h"

namespace diminish {

/// Draws what an RGB-D camera sees where it measures no depth (black or shiny surfaces, the shadows
/// of its own projector), if the user's picture confirms it. First ShadowSurfaces; elsewhere:
///
/// 1. A pixel that nothing is known of is as far away as what is around it in its row or column, or
///    anywhere between. At each such distance an RGB-D camera must have no depth there, between
///    depths that were measured around the gap, to take part.
/// 2. The camera's colours at all these distances must be alike: wherever the surface is, it has
///    this colour.
/// 3. The same is done for pixels around the objects, of which the user's camera shows the truth. A
///    connected group of pixels is drawn if it reaches there and matches.
///
/// So a steel pipe, which mirrors something else for the user or is elsewhere than the wall behind
/// it, is not drawn here (see BarSearch).
class DepthGaps {
 public:
  explicit DepthGaps(const Rig& rig);

  /// Looks for shadows of the cameras' projectors. scene.views need not outlive it. Deterministic.
  void find_shadows(const GapScene& scene) { shadows_.find(scene); }

  /// After find_shadows. part: of the picture: the objects and what is around them.
  /// Changes pixels of the mask without a source: provenance::estimated, in the user's colours.
  /// Deterministic. Cost: 5 to 10 million instructions a frame of the bundled recordings.
  void draw(const GapScene& scene, const Rect& part, Reconstruction& reconstruction);

 private:
  /// Something known in a node's row or column.
  struct End {
    float inverse_m;
    int away;  ///< nodes; 0: there is none
  };
  /// What is found of a node.
  struct Node {
    Eigen::Array3f color;
    float inverse_m = 0;  ///< 0: nothing
    std::size_t camera = 0;
    bool is_in_shadow = false;
  };
  /// A range of inverse depths.
  struct Range {
    float low, high, guess;
  };

  int column(int x) const { return part_.x + x * step_; }
  int row(int y) const { return part_.y + y * step_; }
  /// Returns whether something is unknown that the objects hide.
  bool find_known(const Mask& occlusion, const Reconstruction& reconstruction);
  void take_shadows(const GapScene& scene);
  static Range range_of(const End& left, const End& right, const End& above, const End& below);
  void look_along_row(const GapScene& scene, int y);
  Node look(const GapScene& scene, int x, int y, const Range& range) const;
  /// Keeps what is confirmed.
  void confirm(const GapScene& scene);
  /// pixels: those that the node stands for.
  void draw_node(const GapScene& scene, const Node& node, const Rect& pixels,
                 Reconstruction& reconstruction) const;

  ShadowSurfaces shadows_;
  int step_;   ///< pixels from one node to the next
  Rect part_;  ///< of the picture
  // By node.
  Image<float> known_;  ///< inverse depth; 0: unknown; less: not looked at
  Image<End> above_, below_, right_;
  Image<Node> nodes_;
  Mask found_;  ///< and their neighbours
  ConnectedRegions regions_;
  std::vector<float> errors_;
};

}  // namespace diminish
