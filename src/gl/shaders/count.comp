// How many pixels of the region the camera sees. One pixel each.

layout(local_size_x = 64) in;

shared uint drawn;

void main() {
  if (gl_LocalInvocationIndex == 0u) drawn = 0u;
  barrier();
  int index = int(gl_GlobalInvocationID.x);
  ivec2 pixel = region.xy + ivec2(index % region.z, index / region.z);
  if (index < region.z * region.w && inverse_z_at(layer, pixel) != 0u) atomicAdd(drawn, 1u);
  barrier();
  if (gl_LocalInvocationIndex == 0u && drawn > 0u) atomicAdd(work.drawn_pixels, drawn);
}
