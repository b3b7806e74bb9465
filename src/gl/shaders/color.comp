// Looks up the colours of the pixels that show what the camera sees. One pixel of the region each.

layout(local_size_x = 64) in;

layout(std430, binding = 7) buffer Result { uvec2 result[]; };
// Where cameras are blended: what a second one shows (SecondPixel).
layout(std430, binding = 0) buffer Second { uvec2 second[]; };

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = place.y * region.z + place.x;
  // So far the places among the cameras that take part, from 1 on.
  uint own = (layer + 1u) << 24;
  bool is_first = result[index].x == own;
  bool is_second = most_blended > 0u && second[index].x == own;
  if (!is_first && !is_second) return;
  ivec2 pixel = region.xy + place;
  uint seen = own | seen_color(pixel, 1.0 / uintBitsToFloat(kept_inverse_z_at(layer, pixel)));
  if (is_first) result[index].x = seen;
  if (is_second) second[index].x = seen;
}
