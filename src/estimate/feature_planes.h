#pragma once

#include <Eigen/Core>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "estimate/plane_depth.h"

namespace diminish {

/// A picture in which features are looked for.
struct FeaturePicture {
  ImageView<Bgr> picture;
  const Mask& objects;  ///< where none are taken from
  const Lens& lens;
};

/// Finds planes in what two cameras see: ORB features (Rublee et al. 2011) of both pictures that
/// match and lie on each other's epipolar lines; among their points planes by RANSAC (Fischler &
/// Bolles 1981), the one with most points first. A plane with much of the scene behind it is no
/// background and left out. Returns them in the first camera's frame. Cost: 30 ms.
std::vector<InversePlane> find_feature_planes(const FeaturePicture& first,
                                              const FeaturePicture& second,
                                              const RigidTransform& second_from_first, int most);

}  // namespace diminish
