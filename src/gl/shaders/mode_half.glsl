// The object as if made of glass.
uint shown(ivec2 place, uint color, uint origin) {
  vec3 camera = vec3(levels_of(camera_word(index_of(place))));
  return word_of_channels((1.0 - opacity) * vec3(levels_of(color)) + opacity * camera);
}
