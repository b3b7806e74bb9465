#pragma once

#include "memory/keyframe.h"

namespace diminish {

/// What the RGB-D cameras measured earlier, carried from keyframe to keyframe: they may look away
/// or be covered while the user still sees the place.
class CarriedDepth {
 public:
  explicit CarriedDepth(const KeyframeGrid& grid);

  /// Fills inverse_depth (on the grid: 1 / z as it is measured now; 0: not) where the picture still
  /// looks as it did when depth was measured there. Under the objects to remove nothing is filled,
  /// but kept. picture: on the grid. objects: the picture's mask. Cost: 40 ns per place.
  void fill(const RigidTransform& color_from_world, const Image<Bgr>& picture, const Mask& objects,
            Image<float>& inverse_depth);

  void forget() { places_.resize(0, 0); }

 private:
  /// A measured point: exact, so that nothing blurs on the way.
  struct Place {
    Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< z is 0: none
    Bgr color = {};
  };
  static bool looks_like(const Bgr& color, const Image<Bgr>& picture, const Pixel& place);

  KeyframeGrid grid_;
  RigidTransform color_from_world_;
  Image<Place> places_, now_;
};

}  // namespace diminish
