// ColorSmoothing (color_smoothing.h): its guide takes the distances' place, before there are any.

// The picture before smoothing.
layout(std430, binding = 5) buffer Values { uint values[]; };

bool is_seen(ivec2 place) {
  if (!is_in_region(place)) return false;
  uint origin = state[index_of(place)] & 0xFFu;
  return origin != PROVENANCE_CAMERA && origin < PROVENANCE_INPAINTED;
}
