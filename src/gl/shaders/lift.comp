// ShadowLifting::lift: lifts the shadows in all of the region. One invocation per pixel.

layout(local_size_x = 64) in;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  uvec3 light = levels_of(surface[index] >> 8);
  if (all(equal(light, uvec3(255)))) return;
  uvec3 lit = (levels_of(picture[index]) * 255u + light / 2u) / max(light, 1u);
  picture[index] = word_of(min(lit, 255u));
}
