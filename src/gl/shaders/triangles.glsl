// The triangles that are drawn: small ones from the start of the list, large ones from its end.

// Larger ones are shared by a work group.
const int small_side_px = 16;

// The camera in the upper 8 bits, the triangle's id below.
layout(std430, binding = 5) buffer Triangles { uint triangles[]; };
const uint id_bits = 24u;

// Of each pixel of the region, a camera's after the other's: 1 / z as a float's bits, and the
// triangle that is seen.
layout(std430, binding = 6) buffer Layers { uint layers[]; };

uint layer_index(uint camera, ivec2 pixel) {
  int place = (pixel.y - region_y) * region_width + pixel.x - region_x;
  return 2u * (camera * uint(region_width * region_height) + uint(place));
}

// 1 / z in a pixel, which is linear in the picture, and the corners' weights in it.
float inverse_z_from(vec3 edges, float scale, vec3 corners, out vec3 weights) {
  precise float a = edges.x * scale * corners.x;
  precise float b = edges.y * scale * corners.y;
  precise float c = edges.z * scale * corners.z;
  precise float sum = a + b + c;
  weights = vec3(a, b, c);
  return sum;
}
