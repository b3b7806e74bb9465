// Counts the pixels of the region that the camera sees. One invocation per pixel.

layout(local_size_x = 64) in;

shared uint drawn;

void main() {
  if (gl_LocalInvocationIndex == 0u) drawn = 0u;
  barrier();
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x < region.z && inverse_z_at(layer, region.xy + place) != 0u) atomicAdd(drawn, 1u);
  barrier();
  if (gl_LocalInvocationIndex == 0u && drawn > 0u) atomicAdd(work.drawn_pixels, drawn);
}
