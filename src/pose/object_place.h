#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// What an RGB-D camera measures where the colour camera locates an object.
struct PlaceOfObject {
  int marker = 0;
  double seen_through = 0;  ///< share of points on the object, behind which something is measured
  double covered = 0;       ///< share of points on the marker, before which something is measured

  /// With good cameras both are less than a twentieth.
  bool is_wrong() const { return seen_through > 0.2 || covered > 0.25; }
};

/// Whether objects with a marker are where the colour camera locates them: nothing that an RGB-D
/// camera measures lies behind them, nor between the colour camera and the marker, which it sees.
/// The size of an object's marker moves it along the colour camera's rays. That camera cannot tell;
/// an RGB-D camera sees it from the side.
class ObjectPlace {
 public:
  /// Reads the objects' meshes.
  ObjectPlace(const Rig& rig, const Scene& scene);

  /// by_camera: for each RGB-D camera the first object whose place is wrong, or else another;
  /// nothing where it looks at none that the colour camera sees the marker of. Cost: 50 us an
  /// object.
  void find(const FrameSet& frame, const Markers& markers, const Poses& poses,
            std::vector<std::optional<PlaceOfObject>>& by_camera) const;

 private:
  struct Object {
    MarkerSpec marker;
    std::vector<Eigen::Vector3d> points_m;  ///< on it or in it, in the marker's frame
  };
  struct View {
    std::size_t camera;
    RigidTransform depth_from_color;
    ImageView<std::uint16_t> depth;
  };
  std::optional<PlaceOfObject> examine(const Object& object,
                                       const RigidTransform& color_from_marker,
                                       const View& view) const;
  /// How far behind this point something is measured, metres.
  std::optional<double> behind_m(const Eigen::Vector3d& point_in_color_m, const View& view) const;
  bool is_covered(const Eigen::Vector3d& point_in_color_m, const View& view) const;

  Rig rig_;
  Lens color_lens_;
  std::vector<Lens> depth_lenses_;  ///< of each RGB-D camera
  std::vector<Object> objects_;
};

}  // namespace diminish
