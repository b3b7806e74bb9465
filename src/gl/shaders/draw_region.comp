// Writes a region's pixels into a picture's texture: red first, opaque. One invocation per pixel.

layout(local_size_x = 64) in;

layout(location = 0) uniform ivec4 region;  // x, y, width, height
// Row by row: blue, green, red from the lowest byte on.
layout(std430, binding = 0) readonly buffer Pixels { uint pixels[]; };
layout(binding = 0, rgba8ui) writeonly uniform uimage2D picture;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= region.z) return;
  uint pixel = pixels[place.y * region.z + place.x];
  uvec3 color = uvec3(pixel >> 16, pixel >> 8, pixel) & 0xFFu;
  imageStore(picture, region.xy + place, uvec4(color, 255u));
}
