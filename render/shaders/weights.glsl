// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the colours of skin weights. One of three macros is defined and says which colours: RAMP, the weight of the
// active bone as a colour ramp; FILTERED, colours that are interpolated between voxels; VOXELS, the colours of single
// voxels. The weights are stored in ATLASES textures (atlases.glsl).
uniform sampler3D u_weights0;
#if ATLASES > 1
uniform sampler3D u_weights1;
#endif
#if ATLASES > 2
uniform sampler3D u_weights2;
#endif
#if ATLASES > 3
uniform sampler3D u_weights3;
#endif
uniform usampler3D u_weight_index;
uniform vec3 u_weight_texel;
uniform ivec3 u_weight_blocks;
uniform int u_weight_region;

vec4 weights_filtered(uint atlas, vec3 at) {
#if ATLASES > 3
  if (atlas == 4u) return textureLod(u_weights3, at * u_weight_texel, 0.0);
#endif
#if ATLASES > 2
  if (atlas == 3u) return textureLod(u_weights2, at * u_weight_texel, 0.0);
#endif
#if ATLASES > 1
  if (atlas == 2u) return textureLod(u_weights1, at * u_weight_texel, 0.0);
#endif
  return textureLod(u_weights0, at * u_weight_texel, 0.0);
}

vec4 weights_fetched(uint atlas, ivec3 at) {
#if ATLASES > 3
  if (atlas == 4u) return texelFetch(u_weights3, at, 0);
#endif
#if ATLASES > 2
  if (atlas == 3u) return texelFetch(u_weights2, at, 0);
#endif
#if ATLASES > 1
  if (atlas == 2u) return texelFetch(u_weights1, at, 0);
#endif
  return texelFetch(u_weights0, at, 0);
}

const int kRampSteps = 6;
// Colours of the weight ramp, from render/scene/weight_colormap.h.
const vec3 kRamp[kRampSteps + 1] = vec3[kRampSteps + 1](RAMP_COLOURS);

vec3 weight_ramp(float weight) {
  float at = clamp(weight, 0.0, 1.0) * float(kRampSteps);
  vec3 colour = kRamp[0];
  for (int i = 0; i < kRampSteps; ++i) colour += (kRamp[i + 1] - kRamp[i]) * clamp(at - float(i), 0.0, 1.0);
  return colour;
}

// Returns the texel at a position in padded coordinates, filtered or of the single voxel; zeros in air.
vec4 weights_at(vec3 p) {
  ivec3 block = clamp(ivec3(floor(p / float(BLOCK))), ivec3(0), u_weight_blocks - 1);
  uvec4 entry = texelFetch(u_weight_index, block, 0);
  vec3 at = clamp(p - vec3(block) * float(BLOCK), vec3(0.0), vec3(float(BLOCK)) - 1e-3) +
            vec3(entry.xyz) * float(SLOT) + float(APRON);
#ifdef VOXELS
  vec4 texel = weights_fetched(entry.w, ivec3(at));
#else
  vec4 texel = weights_filtered(entry.w, at);
#endif
  return entry.w == 0u ? vec4(0.0) : texel;
}

// Returns the colour of a texel. Alpha is 0 without tissue, else n / 255, where n from 1 to 4 is the range between
// contours in which the active bone's weight lies.
vec4 weight_colour(vec4 texel) {
  vec3 read = texel.rgb / max(texel.a, 1e-3);  // undoes the filter's mixing with air, where all channels are 0
#ifdef RAMP
  vec3 colour = read.g > 0.5 ? EXACT_ZERO : read.b > 0.5 ? EXACT_ONE : weight_ramp(read.r);
  float range = 1.0 + step(0.25, read.r) + step(0.5, read.r) + step(0.75, read.r);
#else
  vec3 colour = read;
  const float range = 1.0;
#endif
  if (u_weight_region != 0 && texel.a > 0.75)
    colour = mix(vec3(dot(colour, vec3(0.3, 0.6, 0.1))), colour, 0.35) * 0.55;  // dims colours outside the region
  return texel.a < 0.004 ? vec4(0.0) : vec4(colour, range / 255.0);
}
