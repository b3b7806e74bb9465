// Merges what several cameras show: the rule of merge_layers (layers.cpp), which takes the camera
// that sees most of the region first. One pixel of the region each.

layout(local_size_x = 64) in;

layout(std430, binding = 1) readonly buffer AllWork { Work works[]; };
// Colour, with the source in the highest byte (0: nothing), and z as a float's bits.
layout(std430, binding = 7) writeonly buffer Result { uvec2 result[]; };

// Whether one camera's turn is before another's.
bool is_before(uint a, uint b) {
  uint drawn_a = works[a].drawn_pixels;
  uint drawn_b = works[b].drawn_pixels;
  return drawn_a > drawn_b || (drawn_a == drawn_b && a < b);
}

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = place.y * region.z + place.x;
  ivec2 pixel = region.xy + place;
  float nearest = 0.0;
  uint chosen = 0u;
  uint last = camera_count;  // whose turn was last; none
  for (uint turn = 0u; turn < camera_count; ++turn) {
    uint next = camera_count;
    for (uint i = 0u; i < camera_count && camera_count > 1u; ++i) {
      bool is_left = last == camera_count || is_before(last, i);
      if (is_left && (next == camera_count || is_before(i, next))) next = i;
    }
    last = camera_count > 1u ? next : 0u;
    uint bits = inverse_z_at(last, pixel);
    float z = 1.0 / uintBitsToFloat(bits);
    if (bits != 0u && (nearest == 0.0 || z < nearest - agreement_m)) {
      nearest = z;
      chosen = last + 1u;
    }
  }
  result[index] = uvec2(chosen << 24, floatBitsToUint(nearest));
}
