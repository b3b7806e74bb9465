// Counts what the holes border on.

layout(local_size_x = 64) in;

void main() {
  ivec2 place = window.xy + ivec2(gl_GlobalInvocationID.xy);
  uint state = state_at(place);
  if (!is_of_plane(state)) return;
  uint index = uint(index_in(window, place));
  uint first = root(index);
  parts[index].parent = first;
  const ivec2 beside[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
  uint on_plane = 0u;
  uint in_front = 0u;
  for (int k = 0; k < 4; ++k) {
    uint other = state_at(place + beside[k]);
    on_plane += other == (state & LABEL) ? 1u : 0u;
    in_front += other == FOREGROUND ? 1u : 0u;
  }
  if (on_plane > 0u) atomicAdd(parts[first].on_plane, on_plane);
  if (in_front > 0u) atomicAdd(parts[first].in_front, in_front);
}
