// Rules 2 and 3 of sdct.h: the triangles of each 2x2 cell that may be seen are put on a list. One
// cell of the camera `y` each.

layout(local_size_x = 64) in;

shared uint found[2];  // small, large
shared uint base[2];

// 0: not to be drawn, 1: small, 2: large.
uint kind_of(uint camera, uint id) {
  uvec3 corners = corners_of(camera, id);
  ivec4 a = positions[corners.x];
  ivec4 b = positions[corners.y];
  ivec4 c = positions[corners.z];
  if (!(is_vertex(a) && is_vertex(b) && is_vertex(c))) return 0u;
  ivec4 box = pixels_of_bounding_box(a.xy, b.xy, c.xy);
  if (box.x > box.z || box.y > box.w) return 0u;
  if (!joined(intBitsToFloat(ivec3(a.w, b.w, c.w)))) return 0u;
  if (!(cross_product(b.xy - a.xy, c.xy - a.xy) > 0.0)) return 0u;
  ivec2 reach = max(max(a.xy, b.xy), c.xy) - min(min(a.xy, b.xy), c.xy);
  return max(reach.x, reach.y) < small_side_px * subpixels ? 1u : 2u;
}

void main() {
  if (gl_LocalInvocationIndex < 2u) found[gl_LocalInvocationIndex] = 0u;
  barrier();
  uint camera = gl_GlobalInvocationID.y;
  uint cell = gl_GlobalInvocationID.x;
  uint width = uint(cameras[camera].depth_width);
  uint height = uint(cameras[camera].depth_height);
  uint kinds[2] = uint[2](0u, 0u);
  uint places[2] = uint[2](0u, 0u);
  if (cell < width * (height - 1u) && cell % width != width - 1u) {
    for (uint i = 0u; i < 2u; ++i) {
      kinds[i] = kind_of(camera, 2u * cell + i);
      if (kinds[i] != 0u) places[i] = atomicAdd(found[kinds[i] - 1u], 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && found[0] > 0u) {
    base[0] = atomicAdd(small_count, found[0]);
    atomicMax(small_groups[0], min((base[0] + found[0] + 63u) / 64u, 65535u));
  }
  if (gl_LocalInvocationIndex == 1u && found[1] > 0u) {
    base[1] = atomicAdd(large_count, found[1]);
    atomicMax(large_groups[0], min(base[1] + found[1], 65535u));
  }
  barrier();
  for (uint i = 0u; i < 2u; ++i) {
    uint entry = (camera << id_bits) | (2u * cell + i);
    if (kinds[i] == 1u) triangles[base[0] + places[i]] = entry;
    if (kinds[i] == 2u) triangles[uint(triangles.length()) - 1u - base[1] - places[i]] = entry;
  }
}
