#pragma once

#include <array>
#include <optional>
#include <string>

#include "diminish/frame_set.h"
#include "diminish/marker_detector.h"
#include "diminish/remote_images.h"
#include "diminish/rig.h"
#include "render/depth_mesh.h"

namespace diminish {

/// What is to be told of a remote camera's images.
struct GlanceWishes {
  std::string marker_dictionary;     ///< empty: no markers are looked for
  std::array<int, 3> spacings_px{};  ///< PoseRefinement::usual_spacings_px
  int samples = 0;                   ///< about so many points (SampleGrid)
  bool exact = false;                ///< brightness travels without rounding

  friend bool operator==(const GlanceWishes&, const GlanceWishes&) = default;
};

/// Reads from a remote RGB-D camera's images what the user's machine needs before they are drawn.
class GlanceMaker {
 public:
  /// Throws Error for an unknown dictionary.
  GlanceMaker(const RgbdCamera& camera, const GlanceWishes& wishes);

  /// images: of this camera's sizes. Cost: 0.3 us per point, and the markers'.
  void make(const RgbdFrame& images, Glance& glance);

 private:
  void copy_depth_around(const Marker& marker, ImageView<std::uint16_t> depth,
                         Glance& glance) const;

  RgbdCamera camera_;
  GlanceWishes wishes_;
  Lens lens_;
  DepthMesh mesh_;
  std::optional<MarkerDetector> detector_;
};

/// The part of a depth image in which a marker of the camera's colour image may be seen: that of
/// the depth pixels that lie within its box, and a little more. Cost: 0.3 ms.
Rect depth_part_of(const Marker& marker, const DepthMesh& mesh, ImageView<std::uint16_t> depth);

}  // namespace diminish
