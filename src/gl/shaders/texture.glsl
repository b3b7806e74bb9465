// Bilinear interpolation in the camera's colour image, rounded to levels like sample_bilinear
// (rasterizer.cpp).

// Blue, green and red of the pixel whose first byte is `byte_index`.
vec3 read_color(uint byte_index) {
  uint word = color_at + (byte_index >> 2);
  uint shift = 8u * (byte_index & 3u);
  uint low = word_at(word) >> shift;
  // The last two bytes of a word begin a pixel that ends in the next.
  if (shift > 8u) low |= word_at(word + 1u) << (32u - shift);
  return vec3(low & 0xFFu, (low >> 8) & 0xFFu, (low >> 16) & 0xFFu);
}

// Packed: blue in the lowest byte, then green and red.
uint sample_bilinear(vec2 place) {
  ivec2 last = color_size - 1;
  ivec2 p0 = clamp(ivec2(place), ivec2(0), last);
  ivec2 p1 = min(p0 + 1, last);
  precise vec2 f = place - vec2(p0);
  uint width = uint(last.x + 1);
  vec3 c00 = read_color(3u * (uint(p0.y) * width + uint(p0.x)));
  vec3 c10 = read_color(3u * (uint(p0.y) * width + uint(p1.x)));
  vec3 c01 = read_color(3u * (uint(p1.y) * width + uint(p0.x)));
  vec3 c11 = read_color(3u * (uint(p1.y) * width + uint(p1.x)));
  precise vec3 top = c00 + f.x * (c10 - c00);
  precise vec3 bottom = c01 + f.x * (c11 - c01);
  precise vec3 blend = top + f.y * (bottom - top);
  uvec3 levels = uvec3(clamp(roundEven(blend), vec3(0), vec3(255)));
  return levels.x | (levels.y << 8) | (levels.z << 16);
}
