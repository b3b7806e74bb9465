// The paper's way: one vertex for each depth pixel.

flat out ivec4 position;
flat out vec2 place;

void main() {
  if (!find_vertex(uint(gl_VertexID), position, place)) position = ivec4(0);
}
