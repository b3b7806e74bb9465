// An RGB-D camera's colour as the colour camera would see it. seen: as in Result and Second.
vec3 mapped_color(uint seen, ivec2 pixel) {
  uint camera = (seen >> 24) - 1u;
  vec4 field = maps[camera].field;
  vec4 lens = maps[camera].lens;
  vec2 p = (vec2(pixel) - lens.yz) / lens.w;
  float gain = 1.0 + field.x * p.x + field.y * p.y + field.z * p.x * p.x + field.w * p.x * p.y +
               lens.x * p.y * p.y;
  vec4 color = vec4(levels_of(seen), 1);
  return clamp(gain, LEAST_FIELD, GREATEST_FIELD) *
         vec3(dot(maps[camera].rows[0], color), dot(maps[camera].rows[1], color),
              dot(maps[camera].rows[2], color));
}

float second_share(int index) { return float(second[index].y) / 255.0; }
