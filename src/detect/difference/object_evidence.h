#pragma once

#include <memory>
#include <vector>

#include "detect/difference/free_space.h"
#include "detect/difference/seen_layers.h"
#include "detect/difference/surface_comparison.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "geometry/ray_table.h"
#include "scene/background_planes.h"

namespace diminish {

/// What a pixel of the small picture shows, as far as RGB-D cameras tell.
enum class Shown : std::uint8_t {
  unknown,       ///< no RGB-D camera sees anything there
  unlike,        ///< something else than they see
  scene,         ///< what an RGB-D camera sees there, and it does not stand free
  object,        ///< something that stands free, as RGB-D cameras see it
  unseen_object  ///< something that no RGB-D camera sees, where they see that nothing else can be
};
inline bool is_object(Shown what) {
  return what == Shown::object || what == Shown::unseen_object;
}

/// Tells objects from the scene. A pixel shows an object where
/// - the picture looks like a surface that is nearer than `clearance` allows, and an RGB-D camera
///   sees another one behind it, or where that surface goes on, down to what it stands on; or
/// - the picture looks like nothing that the RGB-D cameras see there, and they see that nothing can
///   be there unless it is nearer.
class ObjectEvidence {
 public:
  /// color: the user's camera. shrinkage: of the small picture.
  ObjectEvidence(const Intrinsics& color, int shrinkage);

  struct Inputs {
    const Image<Bgr>& picture;  ///< the small one
    const SeenLayers& layers;
    const FreeSpace& free_space;
    const std::vector<BackgroundPlane>& planes;
    /// An object's distance is at most 1 - clearance of that of what it hides.
    float clearance;
  };
  /// Returns the part of the picture that an object may be in: around the evidence. Cost: about 20
  /// ns a pixel.
  Rect find(const Inputs& inputs, Image<Shown>& shown);

  /// How far beyond the evidence an object may go on, in pixels of the small picture.
  static constexpr int guessed_px = 24;

  /// Of the picture that `find` was given: whether it looks like the nearest surface rather than
  /// like the farthest, and whether it shows a colour in a pixel's neighbourhood.
  bool looks_like_nearest(int x, int y) const {
    return difference_(x, y).nearest <= difference_(x, y).farthest;
  }
  bool looks_like(const Bgr& color, int x, int y) const;

  /// Whether a point of the colour camera's frame lies on one of the planes. x, y: pixel of the
  /// small picture.
  bool is_on_plane(const std::vector<BackgroundPlane>& planes, int x, int y, float depth_m) const;

 private:
  struct Component {
    int pixels = 0, free = 0;
    int like_nearest = 0, compared = 0;
  };
  void compare(const Inputs& inputs);
  float find_threshold(const SeenLayers& layers);
  void mark(const Inputs& inputs, float threshold);
  bool lies_on_plane(const Inputs& inputs, int x, int y);
  void collect(const Inputs& inputs, int x, int y);
  Rect decide(const Inputs& inputs, float threshold, Image<Shown>& shown);
  bool is_unlike_around(const Inputs& inputs, int x, int y, float threshold) const;
  void open(Mask& mask, int reach);

  std::shared_ptr<const RayTable> rays_;  ///< of the small picture
  float threshold_ = 0;                   ///< between colours of the same surface, in levels
  Image<Bgr> least_, greatest_, least_around_, greatest_around_, scratch_;
  Image<SurfaceDifference> difference_;
  std::vector<float> values_;
  Mask kind_, object_, unexplained_, scene_, first_, second_;
  std::vector<Eigen::Vector2i> component_, open_ends_;
};

}  // namespace diminish
