// From the reconstruction to the picture: src/gl/composition_block.h. All buffers hold the region,
// row by row.

// A plane normal . x = distance (w), in the colour camera's frame.
struct CastShadow {
  vec4 plane;
  vec4 origin;  // w: the label of the plane
  vec4 along_u, along_v;
};

// color = field(x, y) (matrix rgbd + offset): ColorMap (color_map.h).
struct ColorMap {
  vec4 rows[3];  // of the matrix, each with its channel's offset
  vec4 field;
  vec4 lens;  // the field's fifth coefficient; the picture's centre and half width
  uvec4 source;
};

layout(std140, binding = 2) uniform Composition {
  vec4 planes[MOST_PLANES];
  CastShadow shadows[MOST_PLANES];
  uint plane_count, shadow_count;
  uint camera_at, light_at;  // in `words`
  ivec2 nodes_size;          // of the membrane; 0: there is none
  int ray_columns;
  uint missing_code;         // the provenance of pixels that no camera sees
  uint rim_px;
  float opacity;             // of the object, in the mode half
  bool mixes_second;
  ColorMap maps[MOST_CAMERAS];  // by place among the cameras that take part
};

// Blue, green, red in the lower bytes.
layout(std430, binding = 0) buffer Picture { uint picture[]; };
// Provenance.
layout(std430, binding = 1) buffer State { uint state[]; };
// Reconstruction::surface in the lowest byte, Reconstruction::light above.
layout(std430, binding = 2) buffer Surface { uint surface[]; };
// The distance to the rim of the objects' mask, in steps.
layout(std430, binding = 3) buffer Distances { uint distances[]; };
// The reconstruction: colour, with the camera's place among those that take part, from 1 on, in the
// highest byte (0: nothing was seen), and z as a float's bits.
layout(std430, binding = 7) readonly buffer Result { uvec2 result[]; };

// A second camera's view if cameras are blended, in the same form, and its share in 1/255.
layout(std430, binding = 6) readonly buffer Second { uvec2 second[]; };

const uint color_bits = 0xFFFFFFu;

int index_of(ivec2 place) { return place.y * region.z + place.x; }
bool is_in_region(ivec2 place) {
  return all(greaterThanEqual(place, ivec2(0))) && all(lessThan(place, region.zw));
}

// The colour camera's pixel; the objects' mask in the highest byte.
uint camera_word(int index) { return word_at(camera_at + uint(index)); }
bool is_object(int index) { return camera_word(index) > color_bits; }

uvec3 levels_of(uint word) { return uvec3(word, word >> 8, word >> 16) & 0xFFu; }
uint word_of(uvec3 levels) { return levels.x | levels.y << 8 | levels.z << 16; }
// Rounds to the nearest levels, clamped.
uint word_of_channels(vec3 channels) {
  return word_of(uvec3(clamp(roundEven(channels), vec3(0), vec3(255))));
}

float noise_at(vec2 noise, float depth_m) { return noise.x + noise.y * depth_m * depth_m; }
