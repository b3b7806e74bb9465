// The list of what to draw: small cells from the start (four times the index of the first pixel,
// plus 1 if the first triangle is drawn, plus 2 if the second is), large triangles from the end.

// A work group shares larger ones.
const int small_side_px = 16;

layout(std430, binding = 5) writeonly buffer Triangles { uint triangles[]; };
layout(binding = 5) uniform usamplerBuffer listed;  // the same

// For each pixel of the region, camera after camera: 1 / z as a float's bits, and the visible
// triangle.
layout(std430, binding = 6) buffer Layers { uint layers[]; };

uint layer_index(uint which, ivec2 pixel) {
  ivec2 place = pixel - region.xy;
  return 2u * (which * uint(region.z * region.w) + uint(place.y * region.z + place.x));
}

// 1 / z in a pixel, which is linear in the picture, and the corners' weights in it.
float inverse_z_from(vec3 edges, float scale, vec3 corners, out vec3 weights) {
  precise vec3 products = edges * scale * corners;
  precise float sum = products.x + products.y + products.z;
  weights = products;
  return sum;
}
