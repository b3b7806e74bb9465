// SoftMembrane::solve by one work group: sweeps over the nodes in the CPU's order, with the CPU's
// sums. A node waits for its left and upper neighbours of the same sweep and for the others of the
// last one. So in turn t all nodes of diagonal t - 2 sweep are ready, in every sweep.

layout(local_size_x = 256) in;

void relax(ivec2 node) {
  int own = node.y * nodes_size.x + node.x;
  int value = node_count() + own;
  vec4 sum = nodes[own];
  sum.w += MEMBRANE_FADING;
  if (node.x > 0) sum += vec4(nodes[value - 1].xyz, 1);
  if (node.x + 1 < nodes_size.x) sum += vec4(nodes[value + 1].xyz, 1);
  if (node.y > 0) sum += vec4(nodes[value - nodes_size.x].xyz, 1);
  if (node.y + 1 < nodes_size.y) sum += vec4(nodes[value + nodes_size.x].xyz, 1);
  nodes[value] = vec4(sum.xyz / sum.w, 0);
}

void main() {
  int turns = nodes_size.x + nodes_size.y - 1 + 2 * (MEMBRANE_SWEEPS - 1);
  for (int turn = 0; turn < turns; ++turn) {
    for (int i = int(gl_LocalInvocationIndex); i < nodes_size.y * MEMBRANE_SWEEPS; i += 256) {
      int row = i % nodes_size.y;
      int column = turn - 2 * (i / nodes_size.y) - row;
      if (column >= 0 && column < nodes_size.x) relax(ivec2(column, row));
    }
    memoryBarrierBuffer();
    barrier();
  }
}
