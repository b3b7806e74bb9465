// Shared by the passes that fill by surfaces (src/inpaint/surface_inpainting.cpp), for all labels
// at once. Places are those in the picture; in grid l, the picture's / 2^l.

// b, g, r and a free byte.
layout(std430, binding = 0) buffer Picture { uint picture[]; };
// In the low 8 bits.
layout(std430, binding = 1) buffer Provenance { uint provenance[]; };
// In the low 8 bits; the region's pixels.
layout(std430, binding = 2) buffer Surface { uint surface[]; };
// The window's pixels: the colour that each lends, and in the highest 8 bits its state.
layout(std430, binding = 3) buffer Pixels { uint pixels[]; };
// The window's pixels: another pixel of the same hole, in the end its first one. And for that one:
// how many pixels around the hole are on the hole's plane and how many in front of it.
struct Part {
  uint parent, on_plane, in_front;
};
layout(std430, binding = 4) coherent buffer Parts { Part parts[]; };
// For each cell of the region, the sums of the planes' colours: b | g << 16, r | pixels << 16.
layout(std430, binding = 5) buffer PlaneSums { uvec2 plane_sums[]; };
// The grids from the second on, label by label: three times ten bits of colour, in quarters of a
// level, and the kind.
layout(std430, binding = 6) buffer Cells { uint cells[]; };
// Labels, as bits: those with known pixels, those to fill, and those known in the end. The work
// groups of the passes that fill the rest.
layout(std430, binding = 7) buffer Work {
  uint known_labels, open_labels, rest_is_known, padding;
  uint rest_groups[];
};

// The parts of the picture that the buffers hold: x, y, width, height.
layout(location = 0) uniform ivec4 stored;
layout(location = 1) uniform ivec4 region;
layout(location = 2) uniform ivec4 window;
// The grids of this pass, and where their cells begin.
layout(location = 3) uniform ivec4 fine;
layout(location = 4) uniform ivec4 coarse;
layout(location = 5) uniform int fine_at;
layout(location = 6) uniform int coarse_at;
// What no label's pixels could fill is filled from everything, as label 0.
layout(location = 7) uniform int is_rest;
// The passes that fill the rest: their work groups across and down.
layout(location = 8) uniform ivec2 rest_sizes[REST_PASSES];

// A pixel's state: its label, and whether it is open.
const uint OPEN = 0x80u;
const uint LABEL = 0x7Fu;
const uint FOREGROUND = 0x7Fu;
const uint OUTSIDE = 0xFFu;
const uint REST = OPEN | 0x7Eu;

// A cell's kind.
const uint IS_OPEN = 1u;
const uint IS_KNOWN = 2u;

bool holds(ivec4 rect, ivec2 place) {
  return all(greaterThanEqual(place, rect.xy)) && all(lessThan(place, rect.xy + rect.zw));
}

int index_in(ivec4 rect, ivec2 place) {
  return (place.y - rect.y) * rect.z + place.x - rect.x;
}

uint picture_index(ivec2 place) { return uint(index_in(stored, place)); }

uint state_at(ivec2 place) {
  return holds(window, place) ? pixels[index_in(window, place)] >> 24 : OUTSIDE;
}

// The label layer that an open pixel belongs to.
uint layer_of(uint state) { return state == REST ? 0u : state & LABEL; }

uint pack_cell(vec3 color, uint kind) {
  uvec3 bits = uvec3(clamp(4.0 * color + 0.5, 0.0, 1023.0));
  return bits.x | bits.y << 10 | bits.z << 20 | kind << 30;
}

vec3 color_of(uint cell) {
  return 0.25 * vec3(cell & 1023u, cell >> 10 & 1023u, cell >> 20 & 1023u);
}

vec3 levels_of(uint pixel) { return vec3(pixel & 255u, pixel >> 8 & 255u, pixel >> 16 & 255u); }

uint round_levels(vec3 color) {
  uvec3 levels = uvec3(clamp(color, 0.0, 255.0) + 0.5);
  return levels.x | levels.y << 8 | levels.z << 16;
}

uint cell_at(ivec4 grid, int begin, uint layer, ivec2 place) {
  return holds(grid, place) ? cells[begin + int(layer) * grid.z * grid.w + index_in(grid, place)]
                            : 0u;
}
