// A cell with known cells in it is known, with their mean. Otherwise it is open if it has an open
// one in it.

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  ivec2 place = coarse.xy + ivec2(gl_GlobalInvocationID.xy);
  uint layer = gl_WorkGroupID.z;
  if (!is_solved(layer) || !holds(coarse, place)) return;
  vec4 sum = vec4(0);
  uint kind = 0u;
  for (int i = 0; i < 4; ++i) {
    uint cell = cell_at(fine, fine_at, layer, 2 * place + ivec2(i & 1, i >> 1));
    kind = max(kind, cell >> 30);
    if (cell >> 30 == IS_KNOWN) sum += vec4(color_of(cell), 1);
  }
  cells[coarse_at + int(layer) * coarse.z * coarse.w + index_in(coarse, place)] =
      pack_cell(sum.xyz / max(sum.w, 1.0), kind);
}
