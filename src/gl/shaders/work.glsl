// For each camera: the work groups of the passes that draw, the list's length, and the number of
// drawn pixels.
struct Work {
  uint small_groups[3];
  uint small_count;
  uint large_groups[3];
  uint large_count;
  uint drawn_pixels;
  uint turn;  // the i-th: which camera is merged in the i-th turn
  uint blended;  // in the first entry: how many cameras are blended, in their turns; 0: one is chosen
  uint padding[53];
};

// The current turn's camera.
layout(std430, binding = 4) buffer CameraWork { Work work; };
