// Rule 2: computes how far each turn's camera is trusted (ConfidenceGrid::trust). One invocation
// per cell.

layout(local_size_x = 64) in;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  uint turn = gl_GlobalInvocationID.z;
  if (cell.x >= grid_size().x || turn >= blended_cameras()) return;
  const float weight = 1.0 / float(2 * CELL_REACH + 1);
  float mean = 0.0;
  for (int y = -CELL_REACH; y <= CELL_REACH; ++y) {
    float along_row = 0.0;
    for (int x = -CELL_REACH; x <= CELL_REACH; ++x) {
      along_row += weight * cells[cell_index(turn, cell + ivec2(x, y))].resolution;
    }
    mean += weight * along_row;
  }
  int own = cell_index(turn, cell);
  vec2 middle = vec2(region.xy + CELL_PX * cell) + float(CELL_PX - 1) / 2.0;
  vec3 point = cells[own].z_m * pinhole_ray(middle);
  vec3 away = point - camera_places[works[turn].turn].eye_m.xyz;
  float lengths = sqrt(dot(point, point) * dot(away, away));
  float cosine = dot(point, away) / (lengths + 1e-9);
  // The chord is nearly the angle, and cheaper.
  float angle = sqrt(max(0.0, 2.0 - 2.0 * cosine));
  cells[own].trust = clamp(mean, 0.0, 1.0) / (angle + LEAST_ANGLE);
}
