// Rule 1: finds which cameras see the nearest surface, without slivers. One invocation per pixel of
// the region.

layout(local_size_x = 64) in;

// 1 / z of what a turn's camera shows in a pixel of the region; 0: nothing.
float inverse_z_in_turn(uint turn, ivec2 pixel) {
  return uintBitsToFloat(kept_inverse_z_at(works[turn].turn, pixel));
}

float noise_m(uint turn, ivec2 pixel, float z_m) {
  CameraPlace place = camera_places[works[turn].turn];
  float depth_m = dot(place.forward.xyz, z_m * pinhole_ray(vec2(pixel)) - place.eye_m.xyz);
  return DEPTH_NOISE.x + DEPTH_NOISE.y * depth_m * depth_m;
}

// One bit for each. left_out: bits of those that do not count. there: bits of those that see
// anything.
uint cameras_of_nearest(ivec2 pixel, uint left_out, out uint there) {
  there = 0u;
  uint front = 0u;
  float nearest = 0.0;
  for (uint turn = 0u; turn < blended_cameras(); ++turn) {
    float inverse_z = inverse_z_in_turn(turn, pixel);
    if (inverse_z == 0.0 || (left_out >> turn & 1u) != 0u) continue;
    there |= 1u << turn;
    if (inverse_z > nearest) {
      nearest = inverse_z;
      front = turn;
    }
  }
  if (bitCount(there) < 2) return there;
  float front_z_m = 1.0 / nearest;
  float front_noise_m = noise_m(front, pixel, front_z_m);
  uint seen = 1u << front;
  for (uint others = there & ~seen; others != 0u; others &= others - 1u) {
    uint turn = uint(findLSB(others));
    float z_m = 1.0 / inverse_z_in_turn(turn, pixel);
    float tolerance_m = max(agreement_m, noise_m(turn, pixel, z_m) + front_noise_m);
    if (z_m - front_z_m <= tolerance_m) seen |= 1u << turn;
  }
  return seen;
}

bool is_sliver(uint turn, ivec2 pixel) {
  float z_m = 1.0 / inverse_z_in_turn(turn, pixel);
  float tolerance_m = max(agreement_m, 2.0 * noise_m(turn, pixel, z_m));
  ivec2 first = max(pixel - WINDOW_REACH, region.xy);
  ivec2 last = min(pixel + WINDOW_REACH, region.xy + region.zw - 1);
  ivec2 side = last - first + 1;
  float enough = LEAST_PART * float(side.x * side.y);
  uint camera = works[turn].turn;
  int same = 0;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      float inverse_z = uintBitsToFloat(inverse_z_at(camera, ivec2(x, y)));
      if (inverse_z * (z_m + tolerance_m) > 1.0 && inverse_z * (z_m - tolerance_m) < 1.0) ++same;
    }
    if (float(same) >= enough) return false;
  }
  return true;
}

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z || blended_cameras() == 0u) return;
  ivec2 pixel = region.xy + place;
  uint there = 0u;
  uint seen = is_kept(pixel) ? cameras_of_nearest(pixel, 0u, there) : 0u;
  bool is_lone = bitCount(seen) == 1 && bitCount(there) > 1;
  // Now the surface behind it is seen.
  if (is_lone && is_sliver(uint(findLSB(seen)), pixel)) {
    seen = cameras_of_nearest(pixel, seen, there);
  }
  seen_by[place.y * region.z + place.x] = seen;
}
