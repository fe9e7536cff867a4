// SPDX-License-Identifier: AGPL-3.0-or-later
// Places the faces of the hull around the visible tissue and computes their depth from the eye.
layout(location = 0) in vec3 corner;
uniform mat4 u_clip;
uniform vec4 u_depth;
out float depth;
void main() {
  gl_Position = u_clip * vec4(corner, 1.0);
  depth = dot(u_depth.xyz, corner) + u_depth.w;
}
