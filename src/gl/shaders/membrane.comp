// Laplace's equation with sources on any set of pixels (src/composite/membrane_solver.h), three
// channels at a time: conjugate gradients, preconditioned by a symmetric multigrid V-cycle on 2x2
// aggregates (Braess 1995), as src/composite/laplace_solver.h. One of the passes below, by PASS.
// One cell each, in rows.

layout(local_size_x = 64) in;

// A grid: where its cells begin in the arrays, width and height. The next coarser one likewise.
uniform ivec3 grid;
uniform ivec3 coarse;
// Of the cells that are relaxed: 0 red, 1 black.
uniform int parity;
// The others are still 0.
uniform int from_zero;

// Of each cell: the weights of the edges to the right and down, the diagonal's inverse (0: there is
// no cell) and the anchor's weight.
layout(std430, binding = 0) buffer Weights { vec4 weights[]; };
// The right side; of the finest grid: the residual.
layout(std430, binding = 1) buffer RightSides { vec4 right_sides[]; };
layout(std430, binding = 2) buffer Values { vec4 values[]; };
layout(std430, binding = 3) buffer Directions { vec4 directions[]; };
layout(std430, binding = 4) buffer Images { vec4 images[]; };
// The pixels' right sides and, last, their anchors; -1: not to be solved for. Then the solution.
layout(std430, binding = 5) buffer Solution { vec4 solution[]; };
// Of each row of groups; and what is computed from their sums.
layout(std430, binding = 6) buffer Sums { vec4 sums[]; };
layout(std430, binding = 7) buffer Scalars {
  vec4 residual_product;  // of residual and preconditioned residual
  vec4 beta;
  vec4 alpha;
};

// The same, to be read: of no cell that the pass writes but the invocation's own.
layout(binding = 0) uniform samplerBuffer weights_read;
layout(binding = 1) uniform samplerBuffer right_sides_read;
layout(binding = 2) uniform samplerBuffer values_read;
layout(binding = 3) uniform samplerBuffer directions_read;
layout(binding = 4) uniform samplerBuffer images_read;
layout(binding = 5) uniform samplerBuffer solution_read;

vec4 weight_at(int index) { return texelFetch(weights_read, index); }

int at(ivec2 cell) { return grid.x + cell.y * grid.y + cell.x; }

float left_weight(ivec2 cell) { return cell.x > 0 ? weight_at(at(cell) - 1).x : 0.0; }
float up_weight(ivec2 cell) { return cell.y > 0 ? weight_at(at(cell) - grid.y).y : 0.0; }

// What a neighbour is worth; where there is none, what is read in its place may be anything.
#define NEIGHBOUR(array, weight, index) \
  ((weight) > 0.0 ? (weight) * texelFetch(array, max(index, 0)) : vec4(0))
// The sum over a cell's neighbours of `array`, by their weights.
#define NEIGHBOURS(array, cell, own)                         \
  (NEIGHBOUR(array, left_weight(cell), at(cell) - 1) +       \
   NEIGHBOUR(array, up_weight(cell), at(cell) - grid.y) +    \
   NEIGHBOUR(array, own.x, at(cell) + 1) +                   \
   NEIGHBOUR(array, own.y, at(cell) + grid.y))

shared vec4 shares[64];

// Adds up what the group's cells have, always in the same order.
void add_up(vec4 share) {
  uint own = gl_LocalInvocationIndex;
  shares[own] = share;
  barrier();
  for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
    if (own < half_size) shares[own] += shares[own + half_size];
    barrier();
  }
  if (own == 0u) sums[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = shares[0];
}

// What all groups have.
uniform int groups;
vec4 all_sums() {
  uint own = gl_LocalInvocationIndex;
  vec4 share = vec4(0);
  for (int i = int(own); i < groups; i += 64) share += sums[i];
  shares[own] = share;
  barrier();
  for (uint half_size = 32u; half_size > 0u; half_size /= 2u) {
    if (own < half_size) shares[own] += shares[own + half_size];
    barrier();
  }
  return shares[0];
}

// a / b; 0 where the channel is solved already.
vec4 quotient(vec4 a, vec4 b) {
  bvec4 left = greaterThan(b, vec4(0));
  return mix(vec4(0), a / mix(vec4(1), b, left), left);
}

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  bool is_inside = cell.x < grid.y && cell.y < grid.z;
  int own_at = is_inside ? at(cell) : 0;

#if PASS == SET_UP
  if (!is_inside) return;
  vec4 own = texelFetch(solution_read, own_at);
  bool is_unknown = own.w >= 0.0;
  bool joins_right = is_unknown && cell.x + 1 < grid.y && texelFetch(solution_read, own_at + 1).w >= 0.0;
  bool joins_down = is_unknown && cell.y + 1 < grid.z && texelFetch(solution_read, own_at + grid.y).w >= 0.0;
  weights[own_at] = vec4(joins_right ? 1 : 0, joins_down ? 1 : 0, is_unknown ? 1 : 0,
                         is_unknown ? own.w : 0.0);
  right_sides[own_at] = is_unknown ? vec4(own.xyz, 0) : vec4(0);
  directions[own_at] = vec4(0);
#elif PASS == START
  if (is_inside) solution[own_at] = vec4(0);
  if (cell == ivec2(0)) residual_product = vec4(0);
#elif PASS == COARSEN
  // The cells of the coarse grid: `grid` is the fine one. Two fine edges join neighbouring full
  // cells, of which the coarse edge gets half, as constant interpolation makes it too stiff.
  if (cell.x >= coarse.y || cell.y >= coarse.z) return;
  vec4 sum = vec4(0);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) {
      ivec2 child = 2 * cell + ivec2(x, y);
      if (child.x >= grid.y || child.y >= grid.z) continue;
      vec4 fine = weight_at(at(child));
      sum += vec4(x == 1 ? 0.5 * fine.x : 0.0, y == 1 ? 0.5 * fine.y : 0.0,
                  fine.z > 0.0 ? 1.0 : 0.0, fine.w);
    }
  }
  weights[coarse.x + cell.y * coarse.y + cell.x] = sum;
#elif PASS == INVERT
  if (!is_inside) return;
  vec4 own = weight_at(own_at);
  float diagonal = own.w + own.x + own.y + left_weight(cell) + up_weight(cell);
  weights[own_at].z = own.z > 0.0 && diagonal > 0.0 ? 1.0 / diagonal : 0.0;
#elif PASS == RELAX
  if (!is_inside || ((cell.x + cell.y) & 1) != parity) return;
  vec4 own = weight_at(own_at);
  vec4 sum = texelFetch(right_sides_read, own_at);
  if (from_zero == 0) sum += NEIGHBOURS(values_read, cell, own);
  values[own_at] = own.z * sum;
#elif PASS == RESTRICT
  if (cell.x >= coarse.y || cell.y >= coarse.z) return;
  vec4 sum = vec4(0);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) {
      ivec2 child = 2 * cell + ivec2(x, y);
      if (child.x >= grid.y || child.y >= grid.z) continue;
      vec4 own = weight_at(at(child));
      if (own.z == 0.0) continue;
      sum += texelFetch(right_sides_read, at(child)) + NEIGHBOURS(values_read, child, own) -
             texelFetch(values_read, at(child)) / own.z;
    }
  }
  right_sides[coarse.x + cell.y * coarse.y + cell.x] = sum;
#elif PASS == PROLONG
  if (!is_inside || weight_at(own_at).z == 0.0) return;
  values[own_at] = texelFetch(values_read, own_at) +
                   texelFetch(values_read, coarse.x + (cell.y >> 1) * coarse.y + (cell.x >> 1));
#elif PASS == MULTIPLY_RESIDUAL
  add_up(is_inside ? texelFetch(right_sides_read, own_at) * texelFetch(values_read, own_at)
                   : vec4(0));
#elif PASS == FIND_BETA
  vec4 product = all_sums();
  if (gl_LocalInvocationIndex == 0u) {
    beta = quotient(product, residual_product);
    residual_product = product;
  }
#elif PASS == TURN
  if (is_inside) {
    directions[own_at] =
        texelFetch(values_read, own_at) + beta * texelFetch(directions_read, own_at);
  }
#elif PASS == APPLY
  vec4 share = vec4(0);
  if (is_inside) {
    vec4 own = weight_at(own_at);
    vec4 direction = texelFetch(directions_read, own_at);
    vec4 image = own.z > 0.0 ? direction / own.z - NEIGHBOURS(directions_read, cell, own) : vec4(0);
    images[own_at] = image;
    share = image * direction;
  }
  add_up(share);
#elif PASS == FIND_ALPHA
  vec4 product = all_sums();
  if (gl_LocalInvocationIndex == 0u) alpha = quotient(residual_product, product);
#elif PASS == STEP
  if (!is_inside) return;
  solution[own_at] = texelFetch(solution_read, own_at) + alpha * texelFetch(directions_read, own_at);
  right_sides[own_at] =
      texelFetch(right_sides_read, own_at) - alpha * texelFetch(images_read, own_at);
#endif
}
