// Computes the state of each pixel of the window. Connected pixels of a row begin as one part.

layout(local_size_x = 64) in;

shared uint states[64];
shared uint starts[2];  // as bits

void main() {
  uint own = gl_LocalInvocationID.x;
  ivec2 place = window.xy + ivec2(gl_GlobalInvocationID.xy);
  bool is_inside = holds(window, place);
  uint state = OUTSIDE;
  if (is_inside) {
    bool is_open = (provenance[picture_index(place)] & 0xFFu) == INPAINTED;
    uint label = holds(region, place) ? surface[index_in(region, place)] & LABEL : 0u;
    state = is_open ? OPEN | (label < LABELS ? label : 0u) : label;
  }
  states[own] = state;
  if (own < 2u) starts[own] = 0u;
  barrier();
  if (own == 0u || states[own - 1u] != state) atomicOr(starts[own >> 5], 1u << (own & 31u));
  barrier();
  if (gl_GlobalInvocationID.xy == uvec2(0)) {
    known_labels = 0u;
    open_labels = 0u;
    rest_is_known = 0u;
  }
  if (!is_inside) return;
  uint index = uint(index_in(window, place));
  uint before = starts[own >> 5] & (0xFFFFFFFFu >> (31u - (own & 31u)));
  uint start = before != 0u ? (own & ~31u) + uint(findMSB(before)) : uint(findMSB(starts[0]));
  pixels[index] = state << 24;
  parts[index] = Part(index - own + start, 0u, 0u);
}
