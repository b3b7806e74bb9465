// Fills polygons by the rule of src/detect/silhouette/polygons.h: one part per work group, one row per thread.

layout(local_size_x = 32) in;

layout(location = 0) uniform uvec2 counts;  // of parts, and of an image's objects

const int subpixels = 256;

bool crosses(ivec2 a, ivec2 b, int row_y) { return (a.y <= row_y) != (b.y <= row_y); }

// The first column whose centre is at the edge or right of it. All numbers are whole and below
// 2^53; only the quotient can be rounded, and that is corrected.
int first_column(ivec2 a, ivec2 b, int row_y) {
  if (a.y > b.y) {
    ivec2 other = a;
    a = b;
    b = other;
  }
  double height = double(b.y - a.y);
  double x = double(a.x) * height + double(row_y - a.y) * double(b.x - a.x);
  double unit = height * double(subpixels);
  double column = floor(x / unit);
  double rest = x - column * unit;
  if (rest < 0.0) {
    column -= 1.0;
    rest += unit;
  }
  if (rest >= unit) {
    column += 1.0;
    rest -= unit;
  }
  return int(column) + (rest > 0.0 ? 1 : 0);
}

// The word's pixels from one of its columns on.
uint pixels_from(int column) { return column <= 0 ? ~0u : column >= 32 ? 0u : ~0u << column; }

void main() {
  uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (index >= counts.x) return;
  Part part = parts[index];
  MaskImage image = images[part.place / counts.y];
  int row = part.first_row + int(gl_LocalInvocationID.x);
  if (row >= image.begin.y + image.size.y) return;
  int row_y = row * subpixels;

  int first = image.width;
  int last = 0;
  ivec2 previous = corners[part.end - 1u];
  for (uint i = part.begin; i < part.end; ++i) {
    ivec2 corner = corners[i];
    if (crosses(previous, corner, row_y)) {
      int column = clamp(first_column(previous, corner, row_y), 0, image.width);
      first = min(first, column);
      last = max(last, column);
    }
    previous = corner;
  }

  bool any = false;
  int row_begin = int(image.first_word) + (row - image.begin.y) * image.size.x - image.begin.x;
  for (int word = first / 32; word * 32 < last; ++word) {
    uint inside = 0u;
    previous = corners[part.end - 1u];
    for (uint i = part.begin; i < part.end; ++i) {
      ivec2 corner = corners[i];
      if (crosses(previous, corner, row_y)) {
        int column = clamp(first_column(previous, corner, row_y), 0, image.width);
        inside ^= pixels_from(column - 32 * word);
      }
      previous = corner;
    }
    if (inside == 0u) continue;
    atomicOr(drawn[row_begin + word], inside);
    any = true;
  }
  if (any) covers[part.place] = 1u;
}
