// The background, with a line where the object is.
uint shown(ivec2 place, uint color, uint origin) {
  for (int i = 1; i <= OUTLINE_WIDTH_PX; ++i) {
    for (int side = 0; side < 4; ++side) {
      ivec2 step = (side < 2 ? ivec2(i, 0) : ivec2(0, i)) * (side % 2 == 0 ? 1 : -1);
      if (is_in_region(place + step) && !is_object(index_of(place + step))) {
        return word_of_channels(OUTLINE_LINE_COLOR);
      }
    }
  }
  return color;
}
