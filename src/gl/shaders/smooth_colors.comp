// Each seen pixel becomes a mean of its neighbours, weighted by how alike their guide is. One
// invocation per pixel of the region.

layout(local_size_x = 64) in;

uniform int share;  // of the change, out of SMOOTHING_WHOLE_CHANGE

const ivec2 neighbours[] = SMOOTHING_NEIGHBOURS;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  if (distances[index] == 0u) return;
  ivec3 own = ivec3(levels_of(distances[index]));
  uvec3 sum = uvec3(0);
  uint weights = 0u;
  for (int i = 0; i < neighbours.length(); ++i) {
    if (!is_in_region(place + neighbours[i])) continue;
    int other = index_of(place + neighbours[i]);
    if (distances[other] == 0u) continue;
    ivec3 apart = abs(ivec3(levels_of(distances[other])) - own);
    int left = SMOOTHING_LARGEST_DIFFERENCE - (apart.x + apart.y + apart.z);
    uint weight = uint(max(left, 0)) / SMOOTHING_WEIGHT_PART;
    weights += weight;
    sum += weight * levels_of(values[other]);
  }
  uint inverse = (SMOOTHING_ONE + weights / 2u) / weights;
  ivec3 value = ivec3(levels_of(values[index]));
  ivec3 change = ivec3((sum + weights / 2u) * inverse / SMOOTHING_ONE) - value;
  const int whole = SMOOTHING_WHOLE_CHANGE;
  // Negative changes are rounded down, too.
  picture[index] = word_of(uvec3(value + (change * share + whole / 2 + 256 * whole) / whole - 256));
}
