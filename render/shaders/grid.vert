// SPDX-License-Identifier: AGPL-3.0-or-later
// Places the square on the ground on which the grid is drawn.
uniform mat4 u_clip;
uniform vec3 u_middle;
uniform float u_reach;
out vec2 place;
void main() {
  place = vec2((gl_VertexID & 1) * 2 - 1, (gl_VertexID >> 1) * 2 - 1) * u_reach;
  gl_Position = u_clip * vec4(u_middle + vec3(place, 0.0), 1.0);
}
