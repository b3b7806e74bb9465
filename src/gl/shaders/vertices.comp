// One depth pixel of the camera `y` each.

layout(local_size_x = 64) in;

void main() {
  uint camera = gl_GlobalInvocationID.y;
  uint pixel = gl_GlobalInvocationID.x;
  if (pixel >= uint(cameras[camera].depth_width * cameras[camera].depth_height)) return;
  ivec4 position;
  vec2 place;
  if (!find_vertex(camera, pixel, position, place)) position = ivec4(0);
  positions[cameras[camera].first_pixel + pixel] = position;
  places[cameras[camera].first_pixel + pixel] = place;
}
