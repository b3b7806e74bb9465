// Rule 3: chooses the two most trusted cameras. One invocation per pixel of the region.

layout(local_size_x = 64) in;

// The camera's place in the highest byte (0: nothing), and z as a float's bits.
layout(std430, binding = 7) writeonly buffer Result { uvec2 result[]; };
// The second camera's place in the same form, and its share in 1/255.
layout(std430, binding = 0) writeonly buffer Second { uvec2 second[]; };

float confidence_of(uint turn, ivec2 cell) { return cells[cell_index(turn, cell)].confidence; }

// ConfidenceGrid::row.
float confidence_at(uint turn, ivec2 place) {
  vec2 at = (vec2(place) - float(CELL_PX - 1) / 2.0) / float(CELL_PX);
  at = clamp(at, vec2(0), vec2(grid_size() - 1));
  ivec2 cell = ivec2(at);
  vec2 f = at - vec2(cell);
  float left = mix(confidence_of(turn, cell), confidence_of(turn, cell + ivec2(0, 1)), f.y);
  float right = mix(confidence_of(turn, cell + ivec2(1, 0)), confidence_of(turn, cell + 1), f.y);
  return mix(left, right, f.x);
}

uint place_of_turn(uint turn) { return (works[turn].turn + 1u) << 24; }

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  int index = place.y * region.z + place.x;
  second[index] = uvec2(0);
  if (blended_cameras() == 0u) return;  // merge.comp has written the result
  uint seen = seen_by[index];
  if (seen == 0u) {
    result[index] = uvec2(0);
    return;
  }
  uint turns[2] = uint[2](uint(findLSB(seen)), 0u);
  if (bitCount(seen) > 1) {
    vec3 most = vec3(0);  // of the confidences
    for (uint turn = 0u; turn < blended_cameras(); ++turn) {
      if ((seen >> turn & 1u) == 0u) continue;
      float confidence = confidence_at(turn, place) + LEAST_CONFIDENCE;
      if (confidence > most.x) {
        most = vec3(confidence, most.xy);
        turns = uint[2](turn, turns[0]);
      } else if (confidence > most.y) {
        most = vec3(most.x, confidence, most.y);
        turns[1] = turn;
      } else {
        most.z = max(most.z, confidence);
      }
    }
    vec2 beyond_third = most.xy - most.z;
    float part = beyond_third.y > 0.0 ? beyond_third.y / (beyond_third.x + beyond_third.y) : 0.0;
    uint share = uint(roundEven(255.0 * part));
    if (share > 0u) second[index] = uvec2(place_of_turn(turns[1]), share);
  }
  uint inverse_z = kept_inverse_z_at(works[turns[0]].turn, region.xy + place);
  result[index] =
      uvec2(place_of_turn(turns[0]), floatBitsToUint(1.0 / uintBitsToFloat(inverse_z)));
}
