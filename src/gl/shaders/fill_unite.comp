// Joins runs of pixels that touch: with the row above, and where a work group's row ended.

layout(local_size_x = 64) in;

void unite(uint a, uint b) {
  for (;;) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    uint first = min(a, b);
    uint second = max(a, b);
    // If no other invocation was faster, the second one was the first pixel of its part.
    if (atomicCompSwap(parts[second].parent, second, first) == second) return;
  }
}

void main() {
  ivec2 place = window.xy + ivec2(gl_GlobalInvocationID.xy);
  uint state = state_at(place);
  if (!is_of_plane(state)) return;
  uint index = uint(index_in(window, place));
  bool joins_left = state_at(place - ivec2(1, 0)) == state;
  if (gl_LocalInvocationID.x == 0u && joins_left) unite(index, index - 1u);
  if (state_at(place - ivec2(0, 1)) != state) return;
  // Otherwise the pixel to the left does it.
  if (!joins_left || state_at(place - ivec2(1, 1)) != state) unite(index, index - uint(window.z));
}
