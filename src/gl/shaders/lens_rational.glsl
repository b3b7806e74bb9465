// What lens.glsl needs where a lens is rational.

#define RATIONAL_LENSES

float rational_divisor(Lens lens, float r2) {
  vec4 k = lens.distortion[1];
  precise float divisor = 1.0 + r2 * (k.y + r2 * (k.z + r2 * k.w));
  return divisor;
}

// The change of the ray that takes an error away (Newton's method, without tangential distortion).
vec2 rational_step(Lens lens, vec2 ray, vec2 error) {
  vec4 k = lens.distortion[1];
  float k1 = lens.distortion[0].x, k2 = lens.distortion[0].y, k3 = k.x;
  float r2 = dot(ray, ray);
  float divisor = rational_divisor(lens, r2);
  float radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / divisor;
  float slope = (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3) -
                 radial * (k.y + r2 * (2.0 * k.z + r2 * 3.0 * k.w))) / divisor;
  return (error - ray * (2.0 * slope * dot(ray, error) / (radial + 2.0 * slope * r2))) / radial;
}
