#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "diminish/intrinsics.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "estimate/plane_depth.h"

namespace diminish {

/// Where the planes that the scene names are in a frame. Those that are to be found by features
/// are left to others.
class GivenPlanes {
 public:
  GivenPlanes(const Rig& rig, const Scene& scene);

  struct Found {
    std::size_t index;   ///< in Scene::planes
    InversePlane plane;  ///< in the user's camera's frame
  };
  /// messages: why one is not found, in plain words.
  void find(const Markers& markers, const Poses& poses, std::vector<Found>& found,
            std::vector<std::string>& messages) const;

 private:
  static std::optional<InversePlane> by_world(const GivenPlane& plane, const Poses& poses,
                                              std::string& problem);
  std::optional<InversePlane> by_marker(const GivenPlane& plane, const Markers& markers,
                                        const Poses& poses, std::string& problem) const;

  std::vector<GivenPlane> planes_;
  Lens user_lens_;
  std::vector<Lens> lenses_;
  std::vector<RigidTransform> depth_from_color_;  ///< of each RGB-D camera's sensors
};

}  // namespace diminish
