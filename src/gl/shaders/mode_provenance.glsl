// What was seen, and what was invented, hatched.
uint shown(ivec2 place, uint color, uint origin) {
  bool seen = origin < PROVENANCE_INPAINTED;
  ivec2 pixel = region.xy + place;
  vec3 own = seen ? PROVENANCE_SEEN_COLOR : PROVENANCE_INVENTED_COLOR;
  bool is_line = !seen && (pixel.x + pixel.y) % PROVENANCE_PERIOD_PX < PROVENANCE_LINE_PX;
  float share = is_line ? 1.0 : PROVENANCE_TINT;
  return word_of_channels((1.0 - share) * vec3(levels_of(color)) + share * own);
}
