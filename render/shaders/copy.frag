// SPDX-License-Identifier: AGPL-3.0-or-later
// Copies the picture of the body.
in vec2 ndc;
uniform sampler2D u_picture;
layout(location = 0) out vec4 colour;
void main() { colour = textureLod(u_picture, ndc * 0.5 + 0.5, 0.0); }
