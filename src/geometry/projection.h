#pragma once

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// `Lens` in single precision for per-pixel work: plain expressions in a fixed order, so that a
/// vectorised version can compute the same bits.
struct Projection {
  float fx = 0, fy = 0, cx = 0, cy = 0;
  float k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  float max_radius_squared = 0;

  Projection() = default;
  explicit Projection(const Lens& lens)
      : fx(static_cast<float>(lens.intrinsics().fx)),
        fy(static_cast<float>(lens.intrinsics().fy)),
        cx(static_cast<float>(lens.intrinsics().cx)),
        cy(static_cast<float>(lens.intrinsics().cy)),
        k1(static_cast<float>(lens.intrinsics().distortion[0])),
        k2(static_cast<float>(lens.intrinsics().distortion[1])),
        p1(static_cast<float>(lens.intrinsics().distortion[2])),
        p2(static_cast<float>(lens.intrinsics().distortion[3])),
        k3(static_cast<float>(lens.intrinsics().distortion[4])),
        max_radius_squared(static_cast<float>(lens.max_radius_squared())) {}

  /// The pixel of the ray (x, y, 1); false beyond the distortion polynomial's valid radius.
  bool distort(float x, float y, float& u, float& v) const {
    const float xx = x * x;
    const float yy = y * y;
    const float xy = x * y;
    const float r2 = xx + yy;
    if (!(r2 < max_radius_squared)) return false;
    const float radial = 1.F + r2 * (k1 + r2 * (k2 + r2 * k3));
    const float xd = x * radial + (2.F * p1 * xy + p2 * (r2 + 2.F * xx));
    const float yd = y * radial + (p1 * (r2 + 2.F * yy) + 2.F * p2 * xy);
    u = fx * xd + cx;
    v = fy * yd + cy;
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
