// Rule 1 of sdct.h: a depth pixel becomes a vertex, or does not.

layout(std430, binding = 5) readonly buffer Rays { vec2 rays[]; };

float transformed(Transform t, int axis, vec3 p) {
  precise float value = ((t.rotation[3 * axis] * p.x + t.rotation[3 * axis + 1] * p.y) +
                         t.rotation[3 * axis + 2] * p.z) + t.translation[axis];
  return value;
}

// The pixel of the ray (x, y, 1); false beyond the distortion polynomial's valid radius.
bool distort(Lens lens, float x, float y, out vec2 pixel) {
  precise float xx = x * x;
  precise float yy = y * y;
  precise float xy = x * y;
  precise float r2 = xx + yy;
  precise float radial = 1.0 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
  precise float xd = x * radial + (2.0 * lens.p1 * xy + lens.p2 * (r2 + 2.0 * xx));
  precise float yd = y * radial + (lens.p1 * (r2 + 2.0 * yy) + 2.0 * lens.p2 * xy);
  precise float u = lens.fx * xd + lens.cx;
  precise float v = lens.fy * yd + lens.cy;
  pixel = vec2(u, v);
  return r2 < lens.max_radius_squared;
}

// Where the point is in the picture of a camera that is at `camera_from_depth`.
bool project(Lens lens, Transform camera_from_depth, vec3 point, out vec2 pixel, out float z) {
  z = transformed(camera_from_depth, 2, point);
  if (!(z > NEAR_PLANE_M)) return false;
  return distort(lens, transformed(camera_from_depth, 0, point) / z,
                 transformed(camera_from_depth, 1, point) / z, pixel);
}

bool find_vertex(uint camera, uint pixel, out ivec4 position, out vec2 place) {
  uint value = read_short(cameras[camera].depth_at, pixel);
  if (value == 0u || read_byte(cameras[camera].depth_mask_at, pixel) != 0u) return false;
  vec2 ray = rays[cameras[camera].first_pixel + pixel];
  precise float z = float(value) * cameras[camera].unit_m;
  vec3 point = vec3(ray * z, z);

  float rgbd_z;
  if (!project(cameras[camera].rgbd_color, cameras[camera].rgbd_color_from_depth, point, place,
               rgbd_z)) {
    return false;
  }
  ivec2 size = ivec2(cameras[camera].color_width, cameras[camera].color_height);
  if (!(all(greaterThanEqual(place, vec2(0))) && all(lessThanEqual(place, vec2(size - 1))))) {
    return false;
  }
  ivec2 nearest = ivec2(roundEven(place));
  if (read_byte(cameras[camera].color_mask_at, uint(nearest.y * size.x + nearest.x)) != 0u) {
    return false;
  }

  float color_z;
  vec2 in_picture;
  if (!project(color_lens, cameras[camera].color_from_depth, point, in_picture, color_z) ||
      !all(lessThan(abs(in_picture), vec2(MAX_COORDINATE_PX)))) {
    return false;
  }
  position = ivec4(ivec2(roundEven(in_picture * float(subpixels))), floatBitsToInt(1.0 / color_z),
                   floatBitsToInt(z));
  return true;
}
