// Rule 2: smooths the confidences. One invocation per cell of each turn's camera.

layout(local_size_x = 64) in;

const float weights[3] = SMOOTHING;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  uint turn = gl_GlobalInvocationID.z;
  if (cell.x >= grid_size().x || turn >= blended_cameras()) return;
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y) {
    float along_row = 0.0;
    for (int x = -1; x <= 1; ++x) {
      along_row += weights[x + 1] * cells[cell_index(turn, cell + ivec2(x, y))].trust;
    }
    sum += weights[y + 1] * along_row;
  }
  cells[cell_index(turn, cell)].confidence = sum;
}
