// BackgroundPlanes::label: the plane that each pixel shows or, where nothing was measured, would
// show. One invocation per pixel of the region.

layout(local_size_x = 64) in;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  if (!is_kept(region.xy + place)) {
    surface[index] = SURFACE_UNKNOWN | color_bits << 8;
    return;
  }
  float z = uintBitsToFloat(result[index].y);
  vec2 ray = ray_beside(region.xy + place, 0);
  uint own = SURFACE_FOREGROUND;
  uint nearest = SURFACE_UNKNOWN;
  float greatest = 0.0;
  for (uint k = 0u; k < plane_count; ++k) {
    float inverse = inverse_depth(planes[k], ray);
    if (inverse > greatest) {
      greatest = inverse;
      nearest = SURFACE_FIRST_PLANE + k;
    }
    if (abs(1.0 - inverse * z) * z <= 2.0 * noise_at(PLANE_NOISE, z)) own = SURFACE_FIRST_PLANE + k;
  }
  surface[index] = (z > 0.0 ? own : nearest) | color_bits << 8;
}
