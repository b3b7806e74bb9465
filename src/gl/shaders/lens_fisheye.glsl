// What lens.glsl needs where a lens is a fisheye.

#define FISHEYE_LENSES

// Angle over radius of a ray.
float angle_over_radius(float r2) {
  precise float a = 1.0 + sqrt(1.0 + r2);
  precise float half_tangent2 = r2 / (a * a);
  precise float b = 1.0 + sqrt(1.0 + half_tangent2);
  precise float z = half_tangent2 / (b * b);
  vec4 k = ANGLE_TERMS;
  precise float series = 1.0 + z * (k.x + z * (k.y + z * (k.z + z * k.w)));
  precise float result = 4.0 / (a * b) * series;
  return result;
}

float fisheye_series(Lens lens, float angle2) {
  vec4 k = lens.distortion[0];
  precise float series = 1.0 + angle2 * (k.x + angle2 * (k.y + angle2 * (k.z + angle2 * k.w)));
  return series;
}

// Distorted radius over radius.
float fisheye_factor(Lens lens, float r2) {
  precise float per_radius = angle_over_radius(r2);
  precise float angle2 = per_radius * per_radius * r2;
  precise float factor = per_radius * fisheye_series(lens, angle2);
  return factor;
}

// The ray (x, y, 1) that is distorted to `target`, by Newton's method on its angle.
vec2 fisheye_ray(Lens lens, vec2 target) {
  float radius = length(target);
  if (radius < 1e-6) return target;
  vec4 k = lens.distortion[0];
  float greatest = atan(sqrt(lens.max_radius_squared));
  float angle = min(radius, greatest);
  for (int i = 0; i < 6; ++i) {
    float a2 = angle * angle;
    float slope = 1.0 + a2 * (3.0 * k.x + a2 * (5.0 * k.y + a2 * (7.0 * k.z + a2 * 9.0 * k.w)));
    angle = clamp(angle - (angle * fisheye_series(lens, a2) - radius) / slope, 0.0, greatest);
  }
  return target * (tan(angle) / radius);
}
