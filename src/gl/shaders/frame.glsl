// A frame as the CPU uploads it: src/gl/frame_block.h.

struct Lens {
  vec4 pinhole;  // fx, fy, cx, cy
  vec4 distortion[2];  // as the model orders the coefficients
  float max_radius_squared;
  uint model;
};

// Rows of the rotation, each with its component of the translation.
struct Transform {
  vec4 rows[3];
};

layout(std140, binding = 0) uniform Frame {
  Lens color_lens;
  ivec4 region;  // x, y, width, height
  float threshold_m, inverse_reach, agreement_m;
  uint camera_count;
  // The region's tiles: first column, first row, columns, place in `words`; 0 columns: all are kept.
  ivec3 tiles;
  uint tiles_at;
  uint most_blended;  // if at most so many cameras see something, they are blended; 0: one is chosen
};

// The current turn's RGB-D camera.
layout(std140, binding = 1) uniform Camera {
  Lens rgbd_color;
  Transform rgbd_color_from_depth, color_from_depth;
  ivec2 depth_size, color_size;
  uint depth_at, depth_mask_at, color_mask_at, color_at;  // in `words`
  float unit_m;
  uint first_pixel;  // of this camera's depth image, in the arrays of rays and vertices
  uint source;
  uint layer;  // its place among the cameras that take part
};

// All images, as they are.
layout(binding = 1) uniform usamplerBuffer words;

uint word_at(uint index) { return texelFetch(words, int(index)).x; }

uint read_byte(uint word, uint index) {
  return (word_at(word + (index >> 2)) >> (8u * (index & 3u))) & 0xFFu;
}

// Whether a pixel of the rectangle belongs to the region (TiledRegion::keeps).
bool is_kept(ivec2 pixel) {
  if (tiles.z == 0) return true;
  ivec2 place = pixel / TILE_PX - tiles.xy;
  return read_byte(tiles_at, uint(place.y * tiles.z + place.x)) != 0u;
}

uint read_short(uint word, uint index) {
  return (word_at(word + (index >> 1)) >> (16u * (index & 1u))) & 0xFFFFu;
}
