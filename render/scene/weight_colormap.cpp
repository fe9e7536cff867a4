// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/weight_colormap.h"

#include <algorithm>
#include <cmath>

namespace limber::render {

namespace {

constexpr std::array<glm::vec3, 12> kSwatches = {srgb(0x8FBEFF), srgb(0x7FC97F), srgb(0xD3B3F0), srgb(0xE8A0A8),
                                                 srgb(0x6CC5C0), srgb(0xE3D26F), srgb(0xC9A27C), srgb(0x9FB4C8),
                                                 srgb(0xB9D98B), srgb(0xE7B3D1), srgb(0x8CD0EC), srgb(0xD8B08C)};
constexpr float kDarkest = 0.5f;  // factor [0, 1] on the mixed colour of four bones with equal weights

}  // namespace

glm::vec3 ramp_colour(double weight) {
  const double at = std::clamp(weight, 0.0, 1.0) * (kWeightRamp.size() - 1);
  const std::size_t step = std::min(static_cast<std::size_t>(at), kWeightRamp.size() - 2);
  return glm::mix(kWeightRamp[step], kWeightRamp[step + 1], static_cast<float>(at - static_cast<double>(step)));
}

glm::vec3 weight_colour(int weight) {
  return weight <= 0 ? kExactZero : weight >= kFullWeight ? kExactOne : ramp_colour(weight / double(kFullWeight));
}

glm::vec3 count_colour(int bones) { return kInfluenceCounts[static_cast<std::size_t>(std::clamp(bones, 1, 4) - 1)]; }

glm::vec3 mixed_colour(const Influence& influence, const std::vector<glm::vec3>& swatches) {
  glm::vec3 sum(0);
  int largest = 0;
  for (int i = 0; i < 4; ++i) {
    if (!influence.weight[i]) continue;
    sum += swatches[influence.bone[i]] * (float(influence.weight[i]) / float(kFullWeight));
    largest = std::max<int>(largest, influence.weight[i]);
  }
  const float evenness = std::clamp((1 - float(largest) / float(kFullWeight)) / 0.75f, 0.0f, 1.0f);
  return sum * glm::mix(1.0f, kDarkest, evenness);
}

std::vector<glm::vec3> bone_swatches(const Armature& armature) {
  const int count = static_cast<int>(kSwatches.size());
  std::vector<int> chosen(armature.bones.size());
  // For each bone: the indices of the colours that its children already have.
  std::vector<std::vector<int>> taken(armature.bones.size());
  for (std::size_t bone = 0; bone < armature.bones.size(); ++bone) {
    const int parent = armature.bones[bone].parent;
    int colour = static_cast<int>(bone) % count;
    if (parent >= 0) {
      const std::vector<int>& siblings = taken[static_cast<std::size_t>(parent)];
      const auto clashes = [&](int c) {
        return c == chosen[static_cast<std::size_t>(parent)] ||
               (std::ssize(siblings) < count - 1 && std::find(siblings.begin(), siblings.end(), c) != siblings.end());
      };
      while (clashes(colour)) colour = (colour + 1) % count;
      taken[static_cast<std::size_t>(parent)].push_back(colour);
    }
    chosen[bone] = colour;
  }
  std::vector<glm::vec3> swatches;
  for (const int colour : chosen) swatches.push_back(kSwatches[static_cast<std::size_t>(colour)]);
  return swatches;
}

}  // namespace limber::render
