// Rule 1 of sdct.h: a depth pixel becomes a vertex, or does not.

layout(binding = 4) uniform samplerBuffer rays;

float transformed(vec4 row, vec3 p) {
  precise float value = ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
  return value;
}

// The point's place in the picture of a camera at `camera_from_depth`.
bool project(Lens lens, Transform camera_from_depth, vec3 point, out vec2 pixel, out float z) {
  z = transformed(camera_from_depth.rows[2], point);
  bool is_inside = distort(lens, transformed(camera_from_depth.rows[0], point) / z,
                           transformed(camera_from_depth.rows[1], point) / z, pixel);
  return z > NEAR_PLANE_M && is_inside;
}

bool is_hole(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, depth_size)) &&
         read_short(depth_at, uint(pixel.y * depth_size.x + pixel.x)) == 0u;
}

vec2 ray_of(ivec2 pixel) {
  return texelFetch(rays, int(first_pixel) + pixel.y * depth_size.x + pixel.x).xy;
}

// color_ray.h
vec2 color_ray(uint index) {
  ivec2 pixel = ivec2(int(index) % depth_size.x, int(index) / depth_size.x);
  ivec2 right = pixel;
  right.x += int(is_hole(pixel - ivec2(1, 0))) - int(is_hole(pixel + ivec2(1, 0)));
  ivec2 down = pixel;
  down.y += int(is_hole(pixel - ivec2(0, 1))) - int(is_hole(pixel + ivec2(0, 1)));
  vec2 ray = ray_of(pixel);
  precise vec2 result = ray;
  if (right.x != pixel.x && right.x >= 0 && right.x < depth_size.x) {
    result = result + COLOR_RAY_SHIFT * (ray_of(right) - ray);
  }
  if (down.y != pixel.y && down.y >= 0 && down.y < depth_size.y) {
    result = result + COLOR_RAY_SHIFT * (ray_of(down) - ray);
  }
  return result;
}

bool find_vertex(uint pixel, out ivec4 position, out vec2 place) {
  uint value = read_short(depth_at, pixel);
  if (value == 0u || read_byte(depth_mask_at, pixel) != 0u) return false;
  vec2 ray = texelFetch(rays, int(first_pixel + pixel)).xy;
  precise float z = float(value) * unit_m;
  vec3 point = vec3(ray * z, z);

  float rgbd_z;
  vec3 color_point = vec3(color_ray(pixel) * z, z);
  if (!project(rgbd_color, rgbd_color_from_depth, color_point, place, rgbd_z) ||
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
