// Masks of several images, one bit per pixel: src/gl/mask_drawer.cpp.

// A window of an image's mask, in rows and words of 32 pixels; the leftmost pixel is the lowest
// bit.
struct MaskImage {
  ivec2 begin, size;
  int width;  // of the whole image, pixels
  int margin_px;
  uint first_word;  // in the arrays
};

// Rows of a polygon.
struct Part {
  uint begin, end;  // of its corners
  int first_row;
  uint place;  // in `covers`: an image's objects, then the next image's
};

layout(std430, binding = 0) readonly buffer Images { MaskImage images[]; };
layout(std430, binding = 1) readonly buffer Parts { Part parts[]; };
layout(std430, binding = 2) readonly buffer Corners { ivec2 corners[]; };  // in subpixels
layout(std430, binding = 3) buffer Drawn { uint drawn[]; };
layout(std430, binding = 4) writeonly buffer Grown { uint grown[]; };
layout(std430, binding = 5) writeonly buffer Covers { uint covers[]; };
