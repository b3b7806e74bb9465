#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "geometry/ray_table.h"

namespace diminish {

/// How well the colour camera's picture and the RGB-D cameras' agree. Every depth pixel is drawn
/// into a small version of the colour camera's picture, with the brightness that its own colour
/// sensor saw. Then blocks of both pictures are correlated, which neither exposure nor white
/// balance changes.
class PhotometricAgreement {
 public:
  explicit PhotometricAgreement(const Rig& rig);

  /// The median correlation over blocks with texture, from -1 to 1; nothing if there are too few.
  /// Cost: 50 ns per depth pixel.
  std::optional<double> of(const FrameSet& frame, const Poses& poses, std::size_t camera);

 private:
  Rig rig_;
  Intrinsics small_;
  Lens small_lens_;
  struct Camera {
    Lens color_lens;
    std::shared_ptr<const RayTable> depth_rays;
  };
  std::vector<Camera> cameras_;
};

}  // namespace diminish
