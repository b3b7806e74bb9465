// What the cameras see, from the rasteriser's file before this one.

// 1 / z as a float's bits, of any pixel of the region's rectangle; 0: nothing of the region is seen.
uint inverse_z_at(uint which, ivec2 pixel) {
  return is_kept(pixel) ? kept_inverse_z_at(which, pixel) : 0u;
}
