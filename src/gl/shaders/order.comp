// Sorts the cameras: the one that sees most of the region first, as merge_layers (layers.cpp) does.

layout(local_size_x = 1) in;

void main() {
  for (uint camera = 0u; camera < camera_count; ++camera) {
    uint place = camera;
    for (; place > 0u && drawn_pixels[order[place - 1u]] < drawn_pixels[camera]; --place) {
      order[place] = order[place - 1u];
    }
    order[place] = camera;
  }
}
