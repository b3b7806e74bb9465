// How lenses distort: src/geometry/distortion_formulas.h, operation by operation. Lenses of other
// models than the usual one cost nothing where the rig has none: then the files that define them are
// left out.

// The pixel of the ray (x, y, 1); false beyond the lens's valid radius.
bool distort(Lens lens, float x, float y, out vec2 pixel) {
  precise float r2 = x * x + y * y;
  precise vec2 distorted;
#ifdef FISHEYE_LENSES
  if (lens.model == FISHEYE) {
    distorted = vec2(x, y) * fisheye_factor(lens, r2);
  } else
#endif
  {
    float k1 = lens.distortion[0].x, k2 = lens.distortion[0].y, k3 = lens.distortion[1].x;
    float p1 = lens.distortion[0].z, p2 = lens.distortion[0].w;
    precise float xx = x * x;
    precise float yy = y * y;
    precise float xy = x * y;
    precise float radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
#ifdef RATIONAL_LENSES
    if (lens.model == RATIONAL) radial /= rational_divisor(lens, r2);
#endif
    distorted.x = x * radial + (2.0 * p1 * xy + p2 * (r2 + 2.0 * xx));
    distorted.y = y * radial + (p1 * (r2 + 2.0 * yy) + 2.0 * p2 * xy);
  }
  precise vec2 result = lens.pinhole.xy * distorted + lens.pinhole.zw;
  pixel = result;
  return r2 < lens.max_radius_squared;
}

// The ray (x, y, 1) of a pixel: the inverse of `distort`.
vec2 undistort(Lens lens, vec2 pixel) {
  vec2 target = (pixel - lens.pinhole.zw) / lens.pinhole.xy;
#ifdef FISHEYE_LENSES
  if (lens.model == FISHEYE) return fisheye_ray(lens, target);
#endif
  // By fixed-point iteration; of a rational lens, which may bend more, by Newton's.
  vec2 ray = target;
  for (int i = 0; i < 6; ++i) {
    vec2 distorted;
    distort(lens, ray.x, ray.y, distorted);
    vec2 error = (pixel - distorted) / lens.pinhole.xy;
#ifdef RATIONAL_LENSES
    if (lens.model == RATIONAL) error = rational_step(lens, ray, error);
#endif
    ray += error;
  }
  return ray;
}
