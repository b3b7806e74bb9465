// Rules 2 and 3 of sdct.h: lists what may be visible of each 2x2 cell. One invocation per cell.

layout(local_size_x = 64) in;

shared uint found[2];  // small cells, large triangles
shared uint base[2];

bool is_drawn(ivec4 a, ivec4 b, ivec4 c) {
  ivec4 box = pixels_of_bounding_box(a.xy, b.xy, c.xy);
  return is_vertex(a) && is_vertex(b) && is_vertex(c) && box.x <= box.z && box.y <= box.w &&
         joined(intBitsToFloat(ivec3(a.w, b.w, c.w))) &&
         cross_product(b.xy - a.xy, c.xy - a.xy) > 0.0;
}

bool is_small(ivec2 a, ivec2 b, ivec2 c) {
  ivec2 reach = max(max(a, b), c) - min(min(a, b), c);
  return max(reach.x, reach.y) < small_side_px * subpixels;
}

void main() {
  if (gl_LocalInvocationIndex < 2u) found[gl_LocalInvocationIndex] = 0u;
  barrier();
  uint width = uint(depth_size.x);
  uint cell = gl_GlobalInvocationID.y * width + gl_GlobalInvocationID.x;
  uint drawn = 0u;  // 1: the first triangle, 2: the second
  bool small_cell = false;
  uint place = 0u;
  if (gl_GlobalInvocationID.x + 1u < width) {
    uint first = first_pixel + cell;
    ivec4 a = position_of(first);
    ivec4 b = position_of(first + 1u);
    ivec4 c = position_of(first + width);
    ivec4 e = position_of(first + width + 1u);
    bool first_drawn = is_drawn(a, b, c);
    bool second_drawn = is_drawn(b, e, c);
    drawn = (first_drawn ? 1u : 0u) | (second_drawn ? 2u : 0u);
    small_cell = (!first_drawn || is_small(a.xy, b.xy, c.xy)) &&
                 (!second_drawn || is_small(b.xy, e.xy, c.xy));
    if (drawn != 0u) place = atomicAdd(found[small_cell ? 0 : 1], small_cell ? 1u : bitCount(drawn));
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
  if (drawn != 0u && small_cell) triangles[base[0] + place] = 4u * cell + drawn;
  if (drawn != 0u && !small_cell) {
    uint end = uint(triangles.length()) - 1u - base[1] - place;
    triangles[end] = 2u * cell + (drawn == 2u ? 1u : 0u);
    if (drawn == 3u) triangles[end - 1u] = 2u * cell + 1u;
  }
}
