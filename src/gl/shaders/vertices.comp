// One invocation per depth pixel.

layout(local_size_x = 64) in;

layout(std430, binding = 2) writeonly buffer Positions { ivec4 positions[]; };
// In the RGB-D camera's colour image.
layout(std430, binding = 3) writeonly buffer Places { vec2 places[]; };

void main() {
  uint pixel = gl_GlobalInvocationID.x;
  if (pixel >= uint(depth_size.x * depth_size.y)) return;
  ivec4 position;
  vec2 place;
  if (!find_vertex(pixel, position, place)) position = ivec4(0);
  positions[first_pixel + pixel] = position;
  places[first_pixel + pixel] = place;
}
