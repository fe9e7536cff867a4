// SPDX-License-Identifier: AGPL-3.0-or-later
// Covers the picture with one triangle (three vertices, no attributes) at the far plane. `ndc` is the position in the
// picture, from -1 to 1.
out vec2 ndc;
void main() {
  ndc = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(ndc, 1.0, 1.0);
}
