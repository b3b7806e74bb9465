// Rule 3 of sdct.h in the paper's way: keeps or drops a triangle.

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

flat in ivec4 position[];
flat in vec2 place[];

smooth out vec2 place_in_color;

uniform vec2 picture_size;

void main() {
  for (int i = 0; i < 3; ++i) {
    if (!is_vertex(position[i])) return;
  }
  if (!joined(intBitsToFloat(ivec3(position[0].w, position[1].w, position[2].w)))) return;
  ivec2 origin = position[0].xy;
  if (!(cross_product(position[1].xy - origin, position[2].xy - origin) > 0.0)) return;
  for (int i = 0; i < 3; ++i) {
    float inverse_z = inverse_z_of(position[i]);
    place_in_color = place[i];
    // Pixel centres are at integers here, at halves in OpenGL. Depth is near / z.
    vec2 pixel = vec2(position[i].xy) / float(subpixels) + 0.5;
    gl_Position = vec4(pixel / picture_size * 2.0 - 1.0, NEAR_PLANE_M * inverse_z, 1.0) / inverse_z;
    EmitVertex();
  }
  EndPrimitive();
}
