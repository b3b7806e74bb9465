// What the passes that draw are dispatched with, and how many triangles there are.
layout(std430, binding = 4) buffer Work {
  uint small_groups[3];
  uint small_count;
  uint large_groups[3];
  uint large_count;
  uint drawn_pixels[256];  // by each camera
  uint order[256];         // of the cameras, by drawn pixels
};
