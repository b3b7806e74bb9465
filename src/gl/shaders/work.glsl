// Of a camera: what the passes that draw are dispatched with, how long the list is, and how
// many pixels are drawn.
struct Work {
  uint small_groups[3];
  uint small_count;
  uint large_groups[3];
  uint large_count;
  uint drawn_pixels;
  uint turn;  // the i-th: which camera is merged in the i-th turn
  uint blended;  // of the first: how many cameras are blended, in their turns; 0: one is chosen
  uint padding[53];
};

// Of the camera whose turn it is.
layout(std430, binding = 4) buffer CameraWork { Work work; };
