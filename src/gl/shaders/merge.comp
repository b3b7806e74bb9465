// Merges the views of several cameras by the rule of merge_layers (layers.cpp) if they are not
// blended. One invocation per pixel of the region.

layout(local_size_x = 64) in;

layout(std430, binding = 1) readonly buffer AllWork { Work works[]; };
// Colour, with the source in the highest byte (0: nothing), and z as a float's bits.
layout(std430, binding = 7) writeonly buffer Result { uvec2 result[]; };

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z || works[0].blended > 0u) return;
  int index = place.y * region.z + place.x;
  ivec2 pixel = region.xy + place;
  float nearest = 0.0;
  uint chosen = 0u;
  for (uint i = 0u; i < camera_count; ++i) {
    uint camera = works[i].turn;
    uint bits = inverse_z_at(camera, pixel);
    float z = 1.0 / uintBitsToFloat(bits);
    if (bits != 0u && (nearest == 0.0 || z < nearest - agreement_m)) {
      nearest = z;
      chosen = camera + 1u;
    }
  }
  result[index] = uvec2(chosen << 24, floatBitsToUint(nearest));
}
