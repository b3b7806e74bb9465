// Colour, and 1 / z (w is z) as a float's bits.

smooth in vec2 place_in_color;

layout(location = 0) out uvec2 seen;

void main() {
  seen = uvec2(sample_bilinear(place_in_color), floatBitsToUint(gl_FragCoord.w));
}
