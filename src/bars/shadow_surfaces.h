#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bars/bar_views.h"
#include "diminish/color_map.h"
#include "diminish/frame_set.h"
#include "diminish/image.h"
#include "diminish/occlusion_masks.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene_samples.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// What gaps in depth are closed from.
struct GapScene {
  const BarViews& views;  ///< of this frame
  const FrameSet& frame;
  const Poses& poses;
  const OcclusionMasks& masks;
  std::span<const SceneSample> samples;  ///< what may hide a surface from the user
  ColorMapsBySource color_maps;          ///< of the RGB-D cameras
};

/// Surfaces in the shadow of an RGB-D camera's own projector. A thing keeps the light from what is
/// behind it, but the colour sensor sees it: as far away as the farther one of the gap's two ends
/// in its row.
///
/// Gaps of other kinds (steel, black) would be closed wrongly. So it is measured, for each camera
/// and frame: outside the objects, gaps that are closed must look like the user's picture.
class ShadowSurfaces {
 public:
  explicit ShadowSurfaces(const Rig& rig);

  /// Deterministic. Cost: some million instructions a camera.
  void find(const GapScene& scene);

  /// Calls visit(column, row, inverse depth, camera) for the nodes of a grid where such a surface
  /// is, some more than once. The grid has every `step`-th pixel of every `step`-th row of a part
  /// of the user's picture.
  template <class Visit>
  void for_each_node(const Rect& part, int step, const Visit& visit) const;

 private:
  /// Of the surface, at a depth pixel.
  struct Vertex {
    Eigen::Vector2f at = Eigen::Vector2f::Zero();  ///< in the user's picture
    float inverse_m = 0;                           ///< there; 0: no vertex
    float depth_m = 0;                             ///< for the depth sensor
    bool closes_gap = false;
  };
  struct Place {
    int column, row;  ///< of vertices
    float depth_m;
  };
  struct Camera {
    explicit Camera(const RgbdCamera& camera);

    std::shared_ptr<const RayTable> rays;
    float unit_m;
    FloatTransform user_from_depth{RigidTransform{}};
    int step;           ///< depth pixels from one vertex to the next
    int columns, rows;  ///< of vertices
    std::vector<Place> gaps;
    // Of a camera that is confirmed:
    Image<Vertex> vertices;  ///< in gaps, and next to them; empty until it is the first time
    std::vector<Place> ends;
    bool is_confirmed = false;
  };

  void find_hiding(std::span<const SceneSample> samples);
  static void find_gaps(const GapScene& scene, std::size_t k, int row, Camera& camera);
  static Vertex vertex(const GapScene& scene, const Place& place, const Camera& camera);
  bool is_confirmed(const GapScene& scene, std::size_t k) const;
  static void make_vertices(const GapScene& scene, std::size_t k, Camera& camera);
  static bool are_joined(const Vertex& a, const Vertex& b, const Vertex& c);

  std::vector<Camera> cameras_;
  Image<float> nearest_m_;      ///< by cells of the user's picture: where samples are, in 3 by 3
  Image<float> own_nearest_m_;  ///< in each cell alone, with a cell more on each side
  std::vector<float> nearest_in_column_m_;
};

/// With linear inverse depth: exact for planes.
template <class Visit>
void ShadowSurfaces::for_each_node(const Rect& part, int step, const Visit& visit) const {
  const Eigen::Vector2f corner(static_cast<float>(part.x), static_cast<float>(part.y));
  const int columns = (part.width + step - 1) / step;
  const int rows = (part.height + step - 1) / step;
  const auto draw = [&](const Vertex& a, const Vertex& b, const Vertex& c, std::size_t k) {
    if (!are_joined(a, b, c)) return;
    const auto place = [&](const Vertex& vertex) -> Eigen::Vector2f {
      return (vertex.at - corner) / static_cast<float>(step);
    };
    const Eigen::Vector2f first = place(a);
    const Eigen::Vector2f u = place(b) - first;
    const Eigen::Vector2f v = place(c) - first;
    const float area = u.x() * v.y() - u.y() * v.x();
    if (area == 0) return;
    const Eigen::Vector2f low = first + u.cwiseMin(v).cwiseMin(0);
    const Eigen::Vector2f high = first + u.cwiseMax(v).cwiseMax(0);
    const int bottom = std::min(rows - 1, static_cast<int>(std::floor(high.y())));
    const int right = std::min(columns - 1, static_cast<int>(std::floor(high.x())));
    for (int y = std::max(0, static_cast<int>(std::ceil(low.y()))); y <= bottom; ++y) {
      for (int x = std::max(0, static_cast<int>(std::ceil(low.x()))); x <= right; ++x) {
        const Eigen::Vector2f p = Eigen::Vector2f(x, y) - first;
        const float s = (p.x() * v.y() - p.y() * v.x()) / area;
        const float t = (u.x() * p.y() - u.y() * p.x()) / area;
        if (s < 0 || t < 0 || s + t > 1) continue;
        visit(x, y, a.inverse_m + s * (b.inverse_m - a.inverse_m) + t * (c.inverse_m - a.inverse_m),
              k);
      }
    }
  };
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (!cameras_[k].is_confirmed) continue;
    const Image<Vertex>& vertices = cameras_[k].vertices;
    for (int y = 0; y + 1 < vertices.height(); ++y) {
      const Vertex* const upper = vertices.row(y);
      const Vertex* const lower = vertices.row(y + 1);
      for (int x = 0; x + 1 < vertices.width(); ++x) {
        draw(upper[x], upper[x + 1], lower[x], k);
        draw(upper[x + 1], lower[x + 1], lower[x], k);
      }
    }
  }
}

}  // namespace diminish
