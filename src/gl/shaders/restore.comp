// ShadowLifting::restore_outside: outside the objects' mask the picture is the camera's again, and
// over the last pixels before the rim the shadow returns. One invocation per pixel of the region.

layout(local_size_x = 64) in;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  uint camera = camera_word(index);
  if (camera <= color_bits) {
    picture[index] = camera;
    return;
  }
  uvec3 light = levels_of(surface[index] >> 8);
  if (all(equal(light, uvec3(255)))) return;
  // In steps along rows and columns.
  int distance = SHADOW_FADING_PX;
  for (int dy = max(1 - SHADOW_FADING_PX, -place.y);
       dy <= min(SHADOW_FADING_PX - 1, region.w - 1 - place.y); ++dy) {
    distance = min(distance, abs(dy) + int(distances[index + dy * region.z]));
  }
  const uint full = 255u * uint(SHADOW_FADING_PX);
  uvec3 dark = (255u - light) * uint(SHADOW_FADING_PX - distance);
  picture[index] = word_of((levels_of(picture[index]) * (full - dark) + full / 2u) / full);
}
