// SPDX-License-Identifier: AGPL-3.0-or-later
// The colours of skin weights. A weight of exactly 0 is neutral grey, a weight of exactly 1 is nearly white. Between
// them a ramp runs from blue over green to yellow. Its lightness rises evenly, so that weights can be read without
// seeing hue. Each bone has a pastel colour, its swatch, which is the same in all displays; the active bone is orange.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber::render {

constexpr glm::vec3 srgb(unsigned hex) {
  return {float(hex >> 16 & 255) / 255, float(hex >> 8 & 255) / 255, float(hex & 255) / 255};
}

inline constexpr glm::vec3 kExactZero = srgb(0x5E6269), kExactOne = srgb(0xFFF4D9), kActiveBone = srgb(0xFF9F2E);
// The colours of the ramp at evenly spaced weights from 0 to 1.
inline constexpr std::array<glm::vec3, 7> kWeightRamp = {srgb(0x2B3480), srgb(0x2C5CA6), srgb(0x1F85A8), srgb(0x2BA58F),
                                                         srgb(0x6DBE6B), srgb(0xB9CC4B), srgb(0xF3CF45)};
// The colours of voxels that have weights of 1 to 4 bones.
inline constexpr std::array<glm::vec3, 4> kInfluenceCounts = {srgb(0x5E6269), srgb(0x2C5CA6), srgb(0x2BA58F),
                                                              srgb(0xF3CF45)};

// These functions return sRGB colours in [0, 1].
glm::vec3 ramp_colour(double weight);  // returns a colour of the ramp for a weight in [0, 1], also for exactly 0 and 1
// Returns the colour of a weight given in steps of 1/65535; exactly 0 and 65535 have special colours.
glm::vec3 weight_colour(int weight);
glm::vec3 count_colour(int bones);  // returns the colour of a voxel that has weights of 1 to 4 bones
// Mixes the swatches of the voxel's bones by weight. The colour is darker where the largest weight is smaller.
glm::vec3 mixed_colour(const Influence& influence, const std::vector<glm::vec3>& swatches);
// Returns a colour (swatch) for each bone. It differs from the colour of the bone's parent and, if there are enough
// colours, from the colours of its siblings.
std::vector<glm::vec3> bone_swatches(const Armature& armature);

}  // namespace limber::render
