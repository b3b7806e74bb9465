#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/connected_regions.h"
#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "diminish/rig.h"
#include "diminish/surfaces.h"
#include "geometry/depth_view.h"
#include "geometry/ray_table.h"
#include "scene/background_planes.h"

namespace diminish {

/// The sides of things that the user would see and no RGB-D camera does. Most things on a table or
/// a floor reach down to it. Where an RGB-D camera sees the edge of a thing's top and, in front of
/// what is below that edge, the thing's other side, the rest of it is there, too: below the edge,
/// all the way down.
/// What is only remembered has no such sides: they would hide what is seen now.
class StandingThings {
 public:
  explicit StandingThings(const Rig& rig);

  struct Input {
    const FrameSet& frame;
    const Poses& poses;
    const OcclusionMasks& masks;
    const Rect& objects;  ///< the box of the colour camera's mask
    const Reconstruction& reconstruction;
    const std::vector<BackgroundPlane>& planes;
  };
  /// Copies the labels of `seen` in its region, labels the mask's pixels that would show such sides
  /// as surface_label::standing, and fills `surfaces.standing_depth_m`. A side hides what an RGB-D
  /// camera sees behind it, but nothing that the colour camera saw there itself. Needs a plane that
  /// faces upwards in the picture. Deterministic. Cost: 5 million instructions a frame of the
  /// calendar, whose mask has 170,000 pixels.
  void find(const Input& input, const Surfaces& seen, Surfaces& surfaces);

 private:
  /// An RGB-D camera.
  struct Camera {
    DepthView depth;
    Eigen::Vector3f centre;  ///< in the colour camera's frame
  };
  struct View;
  enum class Place { empty, hidden_by_side, unknown };

  void place_cameras(const Input& input);
  static Place look_at(const View& view, const Camera& camera, const Eigen::Vector3f& point_m,
                       float top_height_m);
  bool is_solid(const View& view, const Eigen::Vector3f& top_m, float height_m) const;
  bool is_top(const View& view, int x, int y) const;
  void lower(const View& view, int x, int y, Surfaces& surfaces) const;
  static void find_edges(const View& view, int y, int begin, int end, std::uint8_t* edges);
  static void close_slits(const View& view, int y, Surfaces& surfaces);
  void drop_loose(const View& view, const Surfaces& seen, Surfaces& surfaces);

  std::vector<Camera> cameras_;
  Projection color_;
  std::shared_ptr<const RayTable> rays_;
  std::vector<std::vector<std::uint8_t>> edges_;  ///< of a row; by group of rows
  ConnectedRegions regions_;
  std::vector<std::uint8_t> is_held_;  ///< by region
};

}  // namespace diminish
