// Grows masks by discs like DiscDilation: one word per thread, one image per row of work groups.

layout(local_size_x = 64) in;

// The largest integer whose square is not larger.
int root_of(int number) {
  int root = int(sqrt(float(number)));
  if ((root + 1) * (root + 1) <= number) ++root;
  if (root * root > number) --root;
  return root;
}

// The pixels of the middle word that are at most `reach` (up to 31) from a set one, found in
// doubling steps.
uint spread(uint left, uint middle, uint right, int reach) {
  uint rightwards = middle;
  uint leftwards = middle;
  for (int done = 0; done < reach;) {
    int by = min(done + 1, reach - done);
    rightwards |= rightwards << by | left >> (32 - by);
    left |= left << by;
    leftwards |= leftwards >> by | right << (32 - by);
    right |= right >> by;
    done += by;
  }
  return rightwards | leftwards;
}

void main() {
  MaskImage image = images[gl_WorkGroupID.y];
  int index = int(gl_GlobalInvocationID.x);
  if (index >= image.size.x * image.size.y) return;
  int column = index % image.size.x;
  int row = index / image.size.x;
  int margin = image.margin_px;
  uint result = 0u;
  for (int y = max(row - margin, 0); y <= min(row + margin, image.size.y - 1); ++y) {
    uint at = image.first_word + uint(y * image.size.x + column);
    uint middle = drawn[at];
    uint left = column > 0 ? drawn[at - 1u] : 0u;
    uint right = column + 1 < image.size.x ? drawn[at + 1u] : 0u;
    if ((left | middle | right) == 0u) continue;
    int dy = y - row;
    result |= spread(left, middle, right, root_of(margin * margin - dy * dy));
    if (result == ~0u) break;
  }
  grown[image.first_word + uint(index)] = result;
}
