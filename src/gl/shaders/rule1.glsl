// Rule 1 of sdct.h: a depth pixel becomes a vertex, or does not.

layout(binding = 4) uniform samplerBuffer rays;

float transformed(vec4 row, vec3 p) {
  precise float value = ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
  return value;
}

// The pixel of the ray (x, y, 1); false beyond the distortion polynomial's valid radius.
bool distort(Lens lens, float x, float y, out vec2 pixel) {
  float k1 = lens.distortion.x, k2 = lens.distortion.y;
  float p1 = lens.distortion.z, p2 = lens.distortion.w;
  precise float xx = x * x;
  precise float yy = y * y;
  precise float xy = x * y;
  precise float r2 = xx + yy;
  precise float radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * lens.k3));
  precise float xd = x * radial + (2.0 * p1 * xy + p2 * (r2 + 2.0 * xx));
  precise float yd = y * radial + (p1 * (r2 + 2.0 * yy) + 2.0 * p2 * xy);
  precise vec2 result = lens.pinhole.xy * vec2(xd, yd) + lens.pinhole.zw;
  pixel = result;
  return r2 < lens.max_radius_squared;
}

// The point's place in the picture of a camera at `camera_from_depth`.
bool project(Lens lens, Transform camera_from_depth, vec3 point, out vec2 pixel, out float z) {
  z = transformed(camera_from_depth.rows[2], point);
  bool is_inside = distort(lens, transformed(camera_from_depth.rows[0], point) / z,
                           transformed(camera_from_depth.rows[1], point) / z, pixel);
  return z > NEAR_PLANE_M && is_inside;
}

bool find_vertex(uint pixel, out ivec4 position, out vec2 place) {
  uint value = read_short(depth_at, pixel);
  if (value == 0u || read_byte(depth_mask_at, pixel) != 0u) return false;
  vec2 ray = texelFetch(rays, int(first_pixel + pixel)).xy;
  precise float z = float(value) * unit_m;
  vec3 point = vec3(ray * z, z);

  float rgbd_z;
  if (!project(rgbd_color, rgbd_color_from_depth, point, place, rgbd_z) ||
      !(all(greaterThanEqual(place, vec2(0))) && all(lessThanEqual(place, vec2(color_size - 1))))) {
    return false;
  }
  ivec2 nearest = ivec2(roundEven(place));
  if (read_byte(color_mask_at, uint(nearest.y * color_size.x + nearest.x)) != 0u) return false;

  float color_z;
  vec2 in_picture;
  if (!project(color_lens, color_from_depth, point, in_picture, color_z) ||
      !all(lessThan(abs(in_picture), vec2(MAX_COORDINATE_PX)))) {
    return false;
  }
  position = ivec4(ivec2(roundEven(in_picture * float(subpixels))), floatBitsToInt(1.0 / color_z),
                   floatBitsToInt(z));
  return true;
}
