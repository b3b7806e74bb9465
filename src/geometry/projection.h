#pragma once

#include <array>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "geometry/distortion.h"

namespace diminish {

/// `Lens` in single precision for per-pixel work.
struct Projection {
  float fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<float, 8> distortion{};  ///< as `model` orders them
  float max_radius_squared = 0;
  LensModel model = LensModel::plumb_bob;

  Projection() = default;
  explicit Projection(const Lens& lens)
      : fx(static_cast<float>(lens.intrinsics().fx)),
        fy(static_cast<float>(lens.intrinsics().fy)),
        cx(static_cast<float>(lens.intrinsics().cx)),
        cy(static_cast<float>(lens.intrinsics().cy)),
        max_radius_squared(static_cast<float>(lens.max_radius_squared())),
        model(lens.intrinsics().lens_model) {
    for (std::size_t i = 0; i < distortion.size(); ++i) {
      distortion[i] = static_cast<float>(lens.intrinsics().distortion[i]);
    }
  }

  /// The pixel of the ray (x, y, 1); false beyond the lens's valid radius.
  bool distort(float x, float y, float& u, float& v) const {
    const float r2 = x * x + y * y;
    if (!(r2 < max_radius_squared)) return false;
    float distorted_x = 0;
    float distorted_y = 0;
    with_lens_model(model, [&](auto chosen) {
      plain::distort_ray<decltype(chosen)::value>(
          distortion, [](float value) { return value; }, x, y, r2, distorted_x, distorted_y);
    });
    u = fx * distorted_x + cx;
    v = fy * distorted_y + cy;
    return true;
  }
};

/// `RigidTransform` in single precision.
struct FloatTransform {
  float r[3][3];
  float t[3];

  explicit FloatTransform(const RigidTransform& transform) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r[i][j] = static_cast<float>(transform.rotation(i, j));
      t[i] = static_cast<float>(transform.translation(i));
    }
  }

  /// One coordinate of the transformed point.
  float apply(int axis, float x, float y, float z) const {
    return ((r[axis][0] * x + r[axis][1] * y) + r[axis][2] * z) + t[axis];
  }
};

}  // namespace diminish
