// The mean of each seen pixel with its neighbours, first along its row, then along its column. One
// invocation per pixel of the region.

layout(local_size_x = 64) in;

uvec3 among(ivec2 place, uvec3 own) {
  return is_seen(place) ? levels_of(picture[index_of(place)]) : own;
}
uvec3 mean_of_three(uvec3 first, uvec3 second, uvec3 own) {
  return ((first + second + 1u) / 2u + own + 1u) / 2u;
}
uvec3 row_mean(ivec2 place) {
  uvec3 own = levels_of(picture[index_of(place)]);
  return mean_of_three(among(place - ivec2(1, 0), own), among(place + ivec2(1, 0), own), own);
}
uvec3 among_rows(ivec2 place, uvec3 own) { return is_seen(place) ? row_mean(place) : own; }

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  values[index] = picture[index];
  distances[index] = 0u;
  if (!is_seen(place)) return;
  uvec3 own = row_mean(place);
  distances[index] = seen_guide | word_of(mean_of_three(among_rows(place - ivec2(0, 1), own),
                                                        among_rows(place + ivec2(0, 1), own), own));
}
