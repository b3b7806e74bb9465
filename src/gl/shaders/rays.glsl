// The rays of the colour camera's pixels: RayGrid (ray_grid.h).

layout(binding = 6) uniform samplerBuffer ray_nodes;

vec2 ray_node(int index) { return texelFetch(ray_nodes, index).xy; }

// The ray of the pixel that is `further` pixels to the right of `pixel`, from the nodes around
// that.
vec2 ray_beside(ivec2 pixel, int further) {
  ivec2 cell = pixel / RAY_STEP;
  float below = float(pixel.y % RAY_STEP) / float(RAY_STEP);
  int node = cell.y * ray_columns + cell.x;
  vec2 left = mix(ray_node(node), ray_node(node + ray_columns), below);
  vec2 right = mix(ray_node(node + 1), ray_node(node + ray_columns + 1), below);
  return left + float(pixel.x % RAY_STEP + further) / float(RAY_STEP) * (right - left);
}

// 1 / z where the ray meets the plane; 0 or negative where it does not.
float inverse_depth(vec4 plane, vec2 ray) { return dot(plane.xyz, vec3(ray, 1)) / plane.w; }
