// CastShadows::shade: the share of the light on the planes that the objects leave. One invocation
// per pixel of the region.

layout(local_size_x = 64) in;

vec3 light_of_cell(uint which, ivec2 cell) {
  uint word = light_at + 3u * ((which * uint(GRID_CELLS) + uint(cell.y)) * uint(GRID_CELLS) + uint(cell.x));
  return uintBitsToFloat(uvec3(word_at(word), word_at(word + 1u), word_at(word + 2u)));
}

// The share of the light that is lost at the point of the plane that a ray meets; 0 beyond the
// grid.
vec3 dark_at(uint which, vec2 ray) {
  float inverse = inverse_depth(shadows[which].plane, ray);
  if (!(inverse > 0.0)) return vec3(0);
  vec3 offset = vec3(ray, 1) / inverse - shadows[which].origin.xyz;
  vec2 at = vec2(dot(shadows[which].along_u.xyz, offset), dot(shadows[which].along_v.xyz, offset)) /
                CELL_M + float(GRID_CELLS / 2);
  if (!(min(at.x, at.y) >= 0.0 && max(at.x, at.y) < float(GRID_CELLS - 1))) return vec3(0);
  ivec2 cell = ivec2(at);
  vec2 f = at - vec2(cell);
  vec3 upper = mix(light_of_cell(which, cell), light_of_cell(which, cell + ivec2(1, 0)), f.x);
  vec3 lower = mix(light_of_cell(which, cell + ivec2(0, 1)), light_of_cell(which, cell + 1), f.x);
  return 1.0 - mix(upper, lower, f.y);
}

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = index_of(place);
  uint label = surface[index] & 0xFFu;
  for (uint i = 0u; i < shadow_count; ++i) {
    if (uint(shadows[i].origin.w) != label) continue;
    ivec2 pixel = region.xy + place;
    ivec2 apart = ivec2(LIGHT_NODE_PX, LIGHT_NODE_ROWS_PX);
    ivec2 first = pixel / apart * apart;
    vec2 f = vec2(pixel - first) / vec2(apart);
    vec3 corners[4];
    float most = 0.0;
    for (int k = 0; k < 4; ++k) {
      corners[k] = dark_at(i, ray_beside(first + ivec2(k & 1, k >> 1) * apart, 0));
      most = max(most, max(max(corners[k].x, corners[k].y), corners[k].z));
    }
    if (most < INVISIBLE_SHADOW) continue;
    vec3 dark = mix(mix(corners[0], corners[2], f.y), mix(corners[1], corners[3], f.y), f.x);
    float z = uintBitsToFloat(result[index].y);
    if (z > 0.0) {
      vec4 plane = shadows[i].plane;
      float height_m = abs(dot(plane.xyz, vec3(ray_beside(pixel, 0), 1) * z) - plane.w);
      dark *= clamp(2.0 - height_m / (SHADOW_FADING_HEIGHT * noise_at(DEPTH_NOISE, z)), 0.0, 1.0);
    }
    surface[index] = label | word_of(uvec3(255.5 - 255.0 * dark)) << 8;
  }
}
