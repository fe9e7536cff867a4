// SPDX-License-Identifier: AGPL-3.0-or-later
// Widens each line segment to a rectangle in pixels.
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
uniform mat4 u_clip;
uniform vec3 u_ahead;
uniform vec2 u_size;
uniform float u_reach;
out float depth, across;
void main() {
  vec4 a = u_clip * vec4(from, 1.0), b = u_clip * vec4(to, 1.0);
  vec2 first = a.xy / a.w * u_size * 0.5, last = b.xy / b.w * u_size * 0.5, along = last - first;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  bool end = (gl_VertexID & 1) == 1;
  across = (gl_VertexID < 2 ? -1.0 : 1.0) * (u_reach + 1.0);
  depth = dot(end ? to : from, u_ahead);
  vec2 pixel = (end ? last + 0.5 * along : first - 0.5 * along) + across * vec2(-along.y, along.x);
  gl_Position = a.w > 0.0 && b.w > 0.0 ? vec4(pixel / (u_size * 0.5), 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
