// SPDX-License-Identifier: AGPL-3.0-or-later
// The colours of skin weights. Exact values are colourless, everything between has colour: a weight of exactly 0 is
// neutral grey, exactly 1 nearly white, and between them a ramp goes from blue over green to yellow, its lightness
// rising evenly so that it reads without hue. Bones have pastel swatches that are the same wherever a bone is shown;
// the active one is orange.
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
// At even distances from 0 to 1.
inline constexpr std::array<glm::vec3, 7> kWeightRamp = {srgb(0x2B3480), srgb(0x2C5CA6), srgb(0x1F85A8), srgb(0x2BA58F),
                                                         srgb(0x6DBE6B), srgb(0xB9CC4B), srgb(0xF3CF45)};
inline constexpr std::array<glm::vec3, 4> kInfluenceCounts = {srgb(0x5E6269), srgb(0x2C5CA6), srgb(0x2BA58F),
                                                              srgb(0xF3CF45)};  // of 1 to 4

// All sRGB, in [0, 1].
glm::vec3 ramp_colour(double weight);  // [0, 1], exact values not apart
glm::vec3 weight_colour(int weight);   // in 1/65535, tested on that number
glm::vec3 count_colour(int bones);     // [1, 4]
// The swatches by their shares; darker the smaller the largest share is.
glm::vec3 mixed_colour(const Influence& influence, const std::vector<glm::vec3>& swatches);
// A swatch for each bone, in turn; a bone differs from the one that it hangs on, and from the others that hang there as
// far as there are colours.
std::vector<glm::vec3> bone_swatches(const Armature& armature);

}  // namespace limber::render
