// SoftMembrane::add: the difference after mapping colours, where the reconstruction reaches beyond
// the objects. One invocation per node of the grid.

layout(local_size_x = 64) in;

const int samples = NODE_PX / SAMPLE_STEP;

void main() {
  int own = int(gl_GlobalInvocationID.x);
  if (own >= node_count()) return;
  ivec2 first = ivec2(own % nodes_size.x, own / nodes_size.x) * NODE_PX - NODE_PX / 2;
  vec4 sum = vec4(0);
  for (int i = 0; i < samples * samples; ++i) {
    ivec2 place = first + SAMPLE_STEP * ivec2(i % samples, i / samples);
    if (!is_in_region(place)) continue;
    int index = index_of(place);
    uint seen = result[index].x;
    uint camera = camera_word(index);
    if (camera > color_bits || seen <= color_bits) continue;
    vec3 own = mapped_color(seen, region.xy + place);
    if (mixes_second && second[index].y > 0u) {
      own = mix(own, mapped_color(second[index].x, region.xy + place), second_share(index));
    }
    vec3 difference = vec3(levels_of(camera)) - own;
    vec3 relative = difference / LARGEST_DIFFERENCE;
    vec3 shares = max(1.0 - relative * relative, 0.0);
    float product = shares.x * shares.y * shares.z;
    float weight = SAMPLE_WEIGHT * product * product;
    sum += vec4(weight * difference, weight);
  }
  nodes[own] = sum;
  nodes[node_count() + own] = vec4(0);
}
