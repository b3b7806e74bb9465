// Looks up the colours of the pixels that show what the camera sees. One pixel of the region each.

layout(local_size_x = 64) in;

layout(std430, binding = 7) buffer Result { uvec2 result[]; };

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= region.z * region.w) return;
  uvec2 own = result[index];
  // So far the place among the cameras that take part, from 1 on.
  if (own.x >> 24 != layer + 1u) return;
  ivec2 pixel = region.xy + ivec2(index % region.z, index / region.z);
  result[index].x = own.x | seen_color(pixel, uintBitsToFloat(own.y));
}
