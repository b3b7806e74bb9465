// The vertices of every camera's depth pixels.

layout(std430, binding = 2) buffer Positions { ivec4 positions[]; };
// In the RGB-D camera's colour image.
layout(std430, binding = 3) buffer Places { vec2 places[]; };

// Rule 2. The pixels of a triangle's corners. id: twice the index of the cell's first pixel, plus 1
// for the second triangle.
uvec3 corners_of(uint camera, uint id) {
  uint first = cameras[camera].first_pixel + (id >> 1);
  uint below = first + uint(cameras[camera].depth_width);
  return (id & 1u) == 0u ? uvec3(first, first + 1u, below) : uvec3(first + 1u, below + 1u, below);
}
