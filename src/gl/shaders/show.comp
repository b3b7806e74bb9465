// Applies the soft rim and the view mode (`shown`). Provenance goes into the highest byte for the
// download. One invocation per pixel of the region.

layout(local_size_x = 64) in;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  uint color = picture[index] & color_bits;
  uint origin = state[index] & 0xFFu;
  if (origin != PROVENANCE_CAMERA) {
    uint inside = rim_px > 0u ? distances[index] : 0u;
    uint whole = rim_px + 1u;
    if (inside > 0u && inside < whole) {
      uvec3 camera = levels_of(camera_word(index));
      color = word_of((camera * (whole - inside) + levels_of(color) * inside + whole / 2u) / whole);
    }
    color = shown(place, color, origin);
  }
  picture[index] = color | origin << 24;
}
