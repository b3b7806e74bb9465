// SoftMembrane's grid: the weighted sum of differences and the weight of each node, and then the
// values.
layout(std430, binding = 5) coherent buffer Nodes { vec4 nodes[]; };

int node_count() { return nodes_size.x * nodes_size.y; }
