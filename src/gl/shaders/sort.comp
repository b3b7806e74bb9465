// Sorts the pixels into camera, seen and missing, and counts them. One invocation per pixel of the
// region.

layout(local_size_x = 64) in;

layout(std430, binding = 4) buffer Counts { uint mask_pixels, missing_pixels; };

shared uint counts[2];

void main() {
  if (gl_LocalInvocationIndex < 2u) counts[gl_LocalInvocationIndex] = 0u;
  barrier();
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x < region.z) {
    int index = index_of(place);
    bool removed = is_object(index);
    uint seen_by = result[index].x >> 24;
    bool missing = removed && seen_by == 0u;
    state[index] = !removed ? PROVENANCE_CAMERA
                            : missing ? missing_code : maps[max(seen_by, 1u) - 1u].source.x;
    picture[index] = removed ? 0u : camera_word(index) & color_bits;
    if (removed) atomicAdd(counts[0], 1u);
    if (missing) atomicAdd(counts[1], 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && counts[0] > 0u) atomicAdd(mask_pixels, counts[0]);
  if (gl_LocalInvocationIndex == 1u && counts[1] > 0u) atomicAdd(missing_pixels, counts[1]);
}
