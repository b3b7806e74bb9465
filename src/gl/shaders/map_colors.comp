// Writes the mapped colours, with the membrane's correction, where an object is removed and
// something is seen. SECOND_VIEW: mixes in the second camera's mapped colours. One invocation per
// pixel of the region.

layout(local_size_x = 64) in;

// SoftMembrane::row.
vec3 correction(ivec2 place) {
  if (nodes_size.x == 0) return vec3(0);
  ivec2 node = place / NODE_PX;
  vec2 f = vec2(place % NODE_PX) / float(NODE_PX);
  int upper = node_count() + node.y * nodes_size.x + node.x;
  int lower = upper + nodes_size.x;
  return mix(mix(nodes[upper].xyz, nodes[lower].xyz, f.y),
             mix(nodes[upper + 1].xyz, nodes[lower + 1].xyz, f.y), f.x);
}

#ifdef SECOND_VIEW
uint seen_at(int index) { return second[index].x; }
#else
uint seen_at(int index) { return result[index].x; }
#endif

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  uint seen = seen_at(index);
  if (seen <= color_bits || !is_object(index)) return;
  uint color = word_of_channels(mapped_color(seen, region.xy + place) + correction(place));
#ifdef SECOND_VIEW
  vec3 first = vec3(levels_of(picture[index]));
  color = word_of_channels(mix(first, vec3(levels_of(color)), second_share(index)));
#endif
  picture[index] = color;
}
