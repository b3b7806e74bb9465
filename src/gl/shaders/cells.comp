// Rules 2 and 3 of sdct.h: the triangles of each 2x2 cell that may be seen are put on a list. One
// cell each.

layout(local_size_x = 64) in;

shared uint found[2];  // small, large
shared uint base[2];

// 0: not to be drawn, 1: small, 2: large.
uint kind_of(ivec4 a, ivec4 b, ivec4 c) {
  ivec4 box = pixels_of_bounding_box(a.xy, b.xy, c.xy);
  bool seen = is_vertex(a) && is_vertex(b) && is_vertex(c) && box.x <= box.z && box.y <= box.w &&
              joined(intBitsToFloat(ivec3(a.w, b.w, c.w))) &&
              cross_product(b.xy - a.xy, c.xy - a.xy) > 0.0;
  ivec2 reach = max(max(a.xy, b.xy), c.xy) - min(min(a.xy, b.xy), c.xy);
  return !seen ? 0u : max(reach.x, reach.y) < small_side_px * subpixels ? 1u : 2u;
}

void main() {
  if (gl_LocalInvocationIndex < 2u) found[gl_LocalInvocationIndex] = 0u;
  barrier();
  uint cell = gl_GlobalInvocationID.x;
  uint width = uint(depth_size.x);
  uint kinds[2] = uint[2](0u, 0u);
  uint order[2] = uint[2](0u, 0u);
  if (cell < width * uint(depth_size.y - 1) && cell % width != width - 1u) {
    uint first = first_pixel + cell;
    ivec4 a = position_of(first);
    ivec4 b = position_of(first + 1u);
    ivec4 c = position_of(first + width);
    ivec4 e = position_of(first + width + 1u);
    kinds[0] = kind_of(a, b, c);
    kinds[1] = kind_of(b, e, c);
    for (uint i = 0u; i < 2u; ++i) {
      if (kinds[i] != 0u) order[i] = atomicAdd(found[kinds[i] - 1u], 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && found[0] > 0u) {
    base[0] = atomicAdd(work.small_count, found[0]);
    atomicMax(work.small_groups[0], min((base[0] + found[0] + 63u) / 64u, 65535u));
  }
  if (gl_LocalInvocationIndex == 1u && found[1] > 0u) {
    base[1] = atomicAdd(work.large_count, found[1]);
    atomicMax(work.large_groups[0], min(base[1] + found[1], 65535u));
  }
  barrier();
  for (uint i = 0u; i < 2u; ++i) {
    if (kinds[i] == 1u) triangles[base[0] + order[i]] = 2u * cell + i;
    if (kinds[i] == 2u) {
      triangles[uint(triangles.length()) - 1u - base[1] - order[i]] = 2u * cell + i;
    }
  }
}
