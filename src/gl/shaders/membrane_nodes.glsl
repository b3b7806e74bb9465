// SoftMembrane's grid: of each node the weighted sum of differences and their weight; then, as many
// again, the values.
layout(std430, binding = 5) coherent buffer Nodes { vec4 nodes[]; };

int node_count() { return nodes_size.x * nodes_size.y; }
