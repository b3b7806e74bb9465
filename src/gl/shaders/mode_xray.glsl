// The background, with the object's edges on top.

// The picture ends where the region does, if that does not end further away from the objects.
float brightness(ivec2 place) {
  ivec2 inside = clamp(place, ivec2(0), region.zw - 1);
  vec3 camera = vec3(levels_of(camera_word(index_of(inside))));
  return (camera.x + 2.0 * camera.y + camera.z) / 4.0;
}

uint shown(ivec2 place, uint color, uint origin) {
  float across = brightness(place + ivec2(1, 0)) - brightness(place - ivec2(1, 0));
  float down = brightness(place + ivec2(0, 1)) - brightness(place - ivec2(0, 1));
  float strength = min(1.0, length(vec2(across, down)) / XRAY_FULL_DIFFERENCE);
  float share = strength < XRAY_LEAST_STRENGTH ? 0.0 : XRAY_OPACITY * strength;
  return word_of_channels((1.0 - share) * vec3(levels_of(color)) + share * XRAY_LINE_COLOR);
}
