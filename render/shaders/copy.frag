// SPDX-License-Identifier: AGPL-3.0-or-later
// Copies the picture of the body, or mixes two pictures of it.
in vec2 ndc;
uniform sampler2D u_picture;
#ifdef MIXED
uniform sampler2D u_other;
uniform float u_share;  // fraction of u_other in the blend, [0, 1]
#endif
layout(location = 0) out vec4 colour;
void main() {
  colour = textureLod(u_picture, ndc * 0.5 + 0.5, 0.0);
#ifdef MIXED
  colour = mix(colour, textureLod(u_other, ndc * 0.5 + 0.5, 0.0), u_share);
#endif
}
