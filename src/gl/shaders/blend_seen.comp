// Rule 1: which cameras see the nearest surface, without slivers. One pixel of the region each.

layout(local_size_x = 64) in;

const float beyond_m = 1e9;  // the depth of nothing

struct Surface {
  float z_m, noise_m;
};

Surface surface_of(uint turn, ivec2 pixel) {
  uint camera = works[turn].turn;
  uint inverse_z = inverse_z_at(camera, pixel);
  if (inverse_z == 0u) return Surface(beyond_m, 0.0);
  float z_m = 1.0 / uintBitsToFloat(inverse_z);
  CameraPlace place = camera_places[camera];
  float depth_m = dot(place.forward.xyz, z_m * pinhole_ray(vec2(pixel)) - place.eye_m.xyz);
  return Surface(z_m, DEPTH_NOISE.x + DEPTH_NOISE.y * depth_m * depth_m);
}

float tolerance_m(Surface a, Surface b) { return max(agreement_m, a.noise_m + b.noise_m); }

// A bit for each. left_out: likewise, those that do not count. there: those that see anything.
uint cameras_of_nearest(ivec2 pixel, uint left_out, out uint there) {
  Surface nearest = Surface(beyond_m, 0.0);
  there = 0u;
  for (uint turn = 0u; turn < blended_cameras(); ++turn) {
    Surface surface = surface_of(turn, pixel);
    if (surface.z_m == beyond_m || (left_out >> turn & 1u) != 0u) continue;
    there |= 1u << turn;
    if (surface.z_m < nearest.z_m) nearest = surface;
  }
  uint seen = 0u;
  for (uint turn = 0u; turn < blended_cameras(); ++turn) {
    if ((there >> turn & 1u) == 0u) continue;
    Surface surface = surface_of(turn, pixel);
    if (surface.z_m - nearest.z_m <= tolerance_m(surface, nearest)) seen |= 1u << turn;
  }
  return seen;
}

bool is_sliver(uint turn, ivec2 pixel) {
  Surface own = surface_of(turn, pixel);
  float tolerance = tolerance_m(own, own);
  ivec2 first = max(pixel - WINDOW_REACH, region.xy);
  ivec2 last = min(pixel + WINDOW_REACH, region.xy + region.zw - 1);
  int same = 0;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      float inverse_z = uintBitsToFloat(inverse_z_at(works[turn].turn, ivec2(x, y)));
      if (inverse_z * (own.z_m + tolerance) > 1.0 && inverse_z * (own.z_m - tolerance) < 1.0) ++same;
    }
  }
  ivec2 side = last - first + 1;
  return float(same) < LEAST_PART * float(side.x * side.y);
}

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z || blended_cameras() == 0u) return;
  ivec2 pixel = region.xy + place;
  uint there;
  uint seen = cameras_of_nearest(pixel, 0u, there);
  bool is_lone = bitCount(seen) == 1 && bitCount(there) > 1;
  // What is behind it is now seen.
  if (is_lone && is_sliver(uint(findLSB(seen)), pixel)) {
    seen = cameras_of_nearest(pixel, seen, there);
  }
  seen_by[place.y * region.z + place.x] = seen;
}
