// The distance of each pixel along its row to the outside of the objects, at most SHADOW_FADING_PX.
// One invocation per pixel of the region.

layout(local_size_x = 64) in;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  int distance = 0;
  for (; distance < SHADOW_FADING_PX; ++distance) {
    bool left_outside = place.x >= distance && !is_object(index - distance);
    bool right_outside = place.x + distance < region.z && !is_object(index + distance);
    if (left_outside || right_outside) break;
  }
  distances[index] = uint(distance);
}
