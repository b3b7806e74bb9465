// The vertices of every camera's depth pixels.

layout(binding = 2) uniform isamplerBuffer positions;
layout(binding = 3) uniform samplerBuffer places;

ivec4 position_of(uint vertex) { return texelFetch(positions, int(vertex)); }
// In the RGB-D camera's colour image.
vec2 place_of(uint vertex) { return texelFetch(places, int(vertex)).xy; }

// Rule 2. The pixels of a triangle's corners. id: twice the index of the cell's first pixel, plus 1
// for the second triangle.
uvec3 corners_of(uint id) {
  uint first = first_pixel + (id >> 1);
  uint below = first + uint(depth_size.x);
  return (id & 1u) == 0u ? uvec3(first, first + 1u, below) : uvec3(first + 1u, below + 1u, below);
}
