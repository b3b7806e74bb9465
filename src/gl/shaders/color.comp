// Looks up the colours of the pixels that show this camera's view. BLENDED: also of those that show
// it as a second view. One invocation per pixel of the region.

layout(local_size_x = 64) in;

layout(std430, binding = 7) buffer Result { uvec2 result[]; };
#ifdef BLENDED
// A second camera's view (SecondPixel).
layout(std430, binding = 0) buffer Second { uvec2 second[]; };
#endif

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = place.y * region.z + place.x;
  ivec2 pixel = region.xy + place;
  // Until now the place among the cameras that take part, from 1 on.
  uint own = (layer + 1u) << 24;
#ifdef BLENDED
  bool is_first = result[index].x == own;
  if (!is_first && second[index].x != own) return;
  uint seen = own | seen_color(pixel, 1.0 / uintBitsToFloat(kept_inverse_z_at(layer, pixel)));
  if (is_first) {
    result[index].x = seen;
  } else {
    second[index].x = seen;
  }
#else
  uvec2 seen = result[index];
  if (seen.x == own) result[index].x = own | seen_color(pixel, uintBitsToFloat(seen.y));
#endif
}
