// Merges what several cameras show (the rule of merge_layers, layers.cpp), and looks the colours up
// that are seen. One pixel of the region each.

layout(local_size_x = 64) in;

// Colour, with the source in the highest byte (0: nothing), and z as a float's bits.
layout(std430, binding = 7) writeonly buffer Result { uvec2 result[]; };

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= region_width * region_height) return;
  ivec2 pixel = ivec2(region_x + index % region_width, region_y + index / region_width);
  float nearest = 0.0;
  uint chosen = 0u;
  for (uint i = 0u; i < camera_count; ++i) {
    uint camera = order[i];
    uint bits = inverse_z_at(camera, pixel);
    if (bits == 0u) continue;
    float z = 1.0 / uintBitsToFloat(bits);
    if (nearest == 0.0 || z < nearest - agreement_m) {
      nearest = z;
      chosen = camera;
    }
  }
  if (nearest == 0.0) {
    result[index] = uvec2(0u);
    return;
  }
  result[index] = uvec2(color_at(chosen, pixel, nearest) | (cameras[chosen].source << 24),
                        floatBitsToUint(nearest));
}
