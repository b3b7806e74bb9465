// ColorSmoothing (color_smoothing.h). Its guide uses the distances' memory before they are
// computed; 0 where nothing is seen.

// The picture before smoothing.
layout(std430, binding = 5) buffer Values { uint values[]; };

const uint seen_guide = 0xFF000000u;

bool is_seen(ivec2 place) {
  if (!is_in_region(place)) return false;
  uint origin = state[index_of(place)] & 0xFFu;
  return origin != PROVENANCE_CAMERA && origin < PROVENANCE_INPAINTED;
}
