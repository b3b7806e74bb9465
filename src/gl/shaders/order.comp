// The order in which cameras are merged: the one that sees most of the region first (layers.cpp).
// Also whether they are blended.

layout(local_size_x = 1) in;

layout(std430, binding = 1) buffer AllWork { Work works[]; };

void main() {
  uint seeing = 0u;
  for (uint camera = 0u; camera < camera_count; ++camera) {
    uint place = camera;
    for (; place > 0u; --place) {
      uint before = works[place - 1u].turn;
      if (works[before].drawn_pixels >= works[camera].drawn_pixels) break;
      works[place].turn = before;
    }
    works[place].turn = camera;
    if (works[camera].drawn_pixels > 0u) ++seeing;
  }
  bool blends = most_blended > 0u && seeing <= most_blended;
  works[0].blended = blends ? max(seeing, 1u) : 0u;
}
