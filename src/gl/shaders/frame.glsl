// A frame as the processor uploads it: src/gl/frame_block.h. Buffers 0 and 1 are one buffer.

struct Lens {
  float fx, fy, cx, cy;
  float k1, k2, p1, p2, k3;
  float max_radius_squared;
};

struct Transform {
  float rotation[9];
  float translation[3];
};

struct Camera {
  Lens rgbd_color;
  Transform rgbd_color_from_depth;
  Transform color_from_depth;
  float unit_m;
  int depth_width, depth_height;
  int color_width, color_height;
  uint first_pixel;  // of this camera's depth image, in the arrays of rays and vertices
  uint depth_at, depth_mask_at, color_mask_at, color_at;  // in `words`
  uint source;
};

layout(std430, binding = 0) readonly buffer Frame {
  Lens color_lens;
  int region_x, region_y, region_width, region_height;
  float threshold_m, inverse_reach;
  float agreement_m;
  uint camera_count;
  Camera cameras[];
};

layout(std430, binding = 1) readonly buffer Images { uint words[]; };

uint read_byte(uint word, uint index) {
  return (words[word + (index >> 2)] >> (8u * (index & 3u))) & 0xFFu;
}

uint read_short(uint word, uint index) {
  return (words[word + (index >> 1)] >> (16u * (index & 1u))) & 0xFFFFu;
}
