// Whether anything of a label's grids is worth computing.
bool is_solved(uint layer) {
  return ((is_rest != 0 ? rest_is_known : known_labels) >> layer & 1u) != 0u;
}

ivec4 coarser(ivec4 grid) {
  ivec2 first = grid.xy >> 1;
  return ivec4(first, ((grid.xy + grid.zw + 1) >> 1) - first);
}
