// Holes: connected open pixels of a plane, united without locks.

// The part's first pixel, as far as known yet.
uint root(uint pixel) {
  uint parent = parts[pixel].parent;
  while (parent != pixel) {
    pixel = parent;
    parent = parts[pixel].parent;
  }
  return pixel;
}

bool is_of_plane(uint state) { return (state & OPEN) != 0u && state != OPEN && state != OUTSIDE; }
