// SoftRim's distances: 0 outside the objects, else 1 plus the number of erosions until the pixel is
// outside; every second erosion also by corners. One erosion, one invocation per pixel of the
// region: a surviving pixel gets one more. Nothing beyond the region is outside.

layout(local_size_x = 64) in;

uniform int erosion;

bool is_inside(ivec2 place) {
  if (!is_in_region(place)) return true;
  int index = index_of(place);
  return erosion == 0 ? is_object(index) : distances[index] > uint(erosion);
}

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  bool inside = is_inside(place);
  if (erosion == 0) distances[index] = inside ? 1u : 0u;
  if (!inside) return;
  for (int i = 0; i < 9; ++i) {
    ivec2 step = ivec2(i % 3, i / 3) - 1;
    if (erosion % 2 == 0 && step.x != 0 && step.y != 0) continue;
    if (!is_inside(place + step)) return;
  }
  distances[index] = uint(erosion) + 2u;
}
