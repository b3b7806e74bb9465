// How many pixels of the region each camera sees. One pixel of the camera `y` each.

layout(local_size_x = 64) in;

shared uint drawn;

void main() {
  if (gl_LocalInvocationIndex == 0u) drawn = 0u;
  barrier();
  uint camera = gl_GlobalInvocationID.y;
  int index = int(gl_GlobalInvocationID.x);
  ivec2 pixel = ivec2(region_x + index % region_width, region_y + index / region_width);
  if (index < region_width * region_height && inverse_z_at(camera, pixel) != 0u) {
    atomicAdd(drawn, 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && drawn > 0u) atomicAdd(drawn_pixels[camera], drawn);
}
