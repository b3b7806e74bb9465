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

// Each component's upper median of what the differences are to `center`.
vec3 medians(vec3 center, bool absolute) {
  vec3 found = vec3(0);
  for (int i = 0; i < count; ++i) {
    vec3 own = differences[i] - center;
    if (absolute) own = vec3(largest_of(abs(own)));
    // Equal ones stand in their order.
    ivec3 rank = ivec3(0);
    for (int j = 0; j < count; ++j) {
      vec3 other = differences[j] - center;
      if (absolute) other = vec3(largest_of(abs(other)));
      rank += ivec3(lessThan(other, own)) + (j < i ? ivec3(equal(other, own)) : ivec3(0));
    }
    found = mix(found, own, equal(rank, ivec3(count / 2)));
  }
  return found;
}

// What to weigh the differences about.
vec3 usual_difference() {
  if (2 * count < samples) return vec3(0);
  vec3 center = medians(vec3(0), false);
  if (largest_of(abs(center)) > LARGEST_MEDIAN) return vec3(0);
  return medians(center, true).x > LARGEST_SPREAD ? vec3(0) : center;
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
