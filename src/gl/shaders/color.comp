// Looks up the colours of the pixels that show what the camera sees. One pixel of the region each.

layout(local_size_x = 64) in;

layout(std430, binding = 7) buffer Result { uvec2 result[]; };

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = place.y * region.z + place.x;
  uvec2 own = result[index];
  // So far the place among the cameras that take part, from 1 on.
  if (own.x >> 24 != layer + 1u) return;
  result[index].x = own.x | seen_color(region.xy + place, uintBitsToFloat(own.y));
}
