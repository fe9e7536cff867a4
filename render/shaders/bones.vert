// SPDX-License-Identifier: AGPL-3.0-or-later
// Places the corners of the bones' triangles, which are given in pixels from the picture's top left corner.
layout(location = 0) in vec2 pixel;
layout(location = 1) in float depth_in;
layout(location = 2) in vec3 local_in;  // xy: distance from the shape's axis or centre; z: the shape's radius; pixels
layout(location = 3) in vec4 colour_in;
uniform vec2 u_size;
out float depth;
out vec3 local;
out vec4 tint;
void main() {
  depth = depth_in;
  local = local_in;
  tint = colour_in;
  gl_Position = vec4(pixel.x / u_size.x * 2.0 - 1.0, 1.0 - pixel.y / u_size.y * 2.0, 0.0, 1.0);
}
