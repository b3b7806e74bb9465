// SoftMembrane::add and weigh_differences: the differences after mapping colours, where the
// reconstruction reaches beyond the objects. One invocation per node of the grid.

layout(local_size_x = 64) in;

const int row_samples = NODE_PX / SAMPLE_STEP;
const int samples = row_samples * row_samples;

vec3 differences[samples];
int count = 0;

float largest_of(vec3 values) { return max(max(values.x, values.y), values.z); }

void find_differences(ivec2 first) {
  for (int i = 0; i < samples; ++i) {
    ivec2 place = first + SAMPLE_STEP * ivec2(i % row_samples, i / row_samples);
    if (!is_in_region(place)) continue;
    int index = index_of(place);
    uint seen = result[index].x;
    uint camera = camera_word(index);
    if (camera > color_bits || seen <= color_bits) continue;
    vec3 own = mapped_color(seen, region.xy + place);
    if (mixes_second && second[index].y > 0u) {
      own = mix(own, mapped_color(second[index].x, region.xy + place), second_share(index));
    }
    differences[count++] = vec3(levels_of(camera)) - own;
  }
}

// Each component's upper median of the first `size` of `values`.
vec3 medians(vec3 values[samples], int size) {
  vec3 found = vec3(0);
  for (int i = 0; i < size; ++i) {
    // Equal ones stand in their order.
    ivec3 rank = ivec3(0);
    for (int j = 0; j < size; ++j) {
      rank += ivec3(lessThan(values[j], values[i])) +
              (j < i ? ivec3(equal(values[j], values[i])) : ivec3(0));
    }
    found = mix(found, values[i], equal(rank, ivec3(size / 2)));
  }
  return found;
}

// What to weigh the differences about: see SoftMembrane::usual.
vec3 usual_difference() {
  if (2 * count < samples) return vec3(0);
  vec3 center = medians(differences, count);
  if (largest_of(abs(center)) > LARGEST_MEDIAN) return vec3(0);
  vec3 deviations[samples];
  vec3 near[samples];
  int near_count = 0;
  for (int i = 0; i < count; ++i) {
    float deviation = largest_of(abs(differences[i] - center));
    deviations[i] = vec3(deviation);
    if (deviation < LARGEST_DEVIATION) near[near_count++] = differences[i];
  }
  if (medians(deviations, count).x > LARGEST_SPREAD) return vec3(0);
  if (2 * near_count < samples) return vec3(0);
  return near_count == count ? center : medians(near, near_count);
}

void main() {
  int own = int(gl_GlobalInvocationID.x);
  if (own >= node_count()) return;
  find_differences(ivec2(own % nodes_size.x, own / nodes_size.x) * NODE_PX - NODE_PX / 2);
  vec3 center = usual_difference();
  vec4 sum = vec4(0);
  for (int i = 0; i < count; ++i) {
    vec3 relative = (differences[i] - center) / LARGEST_DEVIATION;
    vec3 shares = max(1.0 - relative * relative, 0.0);
    float product = shares.x * shares.y * shares.z;
    float weight = SAMPLE_WEIGHT * product * product;
    sum += vec4(weight * differences[i], weight);
  }
  nodes[own] = sum;
  nodes[node_count() + own] = vec4(0);
}
