// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the field of visible tissue and the labels from their ATLASES textures. `atlas` is the number of an atlas
// texture, counted from 1, as the last channel of the index texture stores it. GLSL 3.30 cannot select a sampler by a
// variable, so the functions compare `atlas` with each number.
uniform sampler3D u_field0;
uniform usampler3D u_labels0;
#if ATLASES > 1
uniform sampler3D u_field1;
uniform usampler3D u_labels1;
#endif
#if ATLASES > 2
uniform sampler3D u_field2;
uniform usampler3D u_labels2;
#endif
#if ATLASES > 3
uniform sampler3D u_field3;
uniform usampler3D u_labels3;
#endif
uniform vec3 u_texel;

float field_texel(uint atlas, ivec3 at) {
#if ATLASES > 3
  if (atlas == 4u) return texelFetch(u_field3, at, 0).r;
#endif
#if ATLASES > 2
  if (atlas == 3u) return texelFetch(u_field2, at, 0).r;
#endif
#if ATLASES > 1
  if (atlas == 2u) return texelFetch(u_field1, at, 0).r;
#endif
  return texelFetch(u_field0, at, 0).r;
}

float field_at(uint atlas, vec3 at) {
#if ATLASES > 3
  if (atlas == 4u) return textureLod(u_field3, at * u_texel, 0.0).r;
#endif
#if ATLASES > 2
  if (atlas == 3u) return textureLod(u_field2, at * u_texel, 0.0).r;
#endif
#if ATLASES > 1
  if (atlas == 2u) return textureLod(u_field1, at * u_texel, 0.0).r;
#endif
  return textureLod(u_field0, at * u_texel, 0.0).r;
}

uint label_at(uint atlas, ivec3 at) {
#if ATLASES > 3
  if (atlas == 4u) return texelFetch(u_labels3, at, 0).r;
#endif
#if ATLASES > 2
  if (atlas == 3u) return texelFetch(u_labels2, at, 0).r;
#endif
#if ATLASES > 1
  if (atlas == 2u) return texelFetch(u_labels1, at, 0).r;
#endif
  return texelFetch(u_labels0, at, 0).r;
}
