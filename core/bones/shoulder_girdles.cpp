// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/shoulder_girdles.h"

#include <optional>
#include <string>

#include "core/rig/joint_names.h"

namespace limber {

namespace {

// Tissue within this distance of the shoulder joint counts as shoulder blade, as a share of the upper arm's length. In
// the BodyParts3D man the distance of the shoulder blade is 1/15 of that length, that of the nearest rib 1/5.
constexpr double kReach = 0.15;

}  // namespace

std::vector<ShoulderGirdle> shoulder_girdles(const Armature& armature) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) {
    names.push_back(bone.name);
    parents.push_back(bone.parent);
  }
  const auto roles = joint_roles(names, parents);
  const auto is = [&](int b, BodyPart part) { return b >= 0 && roles[b] && roles[b]->part == part; };
  std::vector<ShoulderGirdle> girdles;
  for (std::size_t arm = 0; arm < roles.size(); ++arm) {
    const int girdle = parents[arm];
    if (!is(static_cast<int>(arm), BodyPart::UpperArm) || !is(girdle, BodyPart::Clavicle)) continue;
    int trunk = parents[girdle];
    while (is(trunk, BodyPart::Clavicle)) trunk = parents[trunk];
    if (trunk < 0) continue;
    const Bone &bone = armature.bones[arm], &collar = armature.bones[girdle];
    const double length = glm::distance(collar.head, collar.tail);
    if (length == 0) continue;
    girdles.push_back({girdle,
                       trunk,
                       bone.head,
                       kReach * glm::distance(bone.head, bone.tail),
                       collar.head,
                       (collar.tail - collar.head) / length,
                       {}});
  }
  if (girdles.size() == 2) {
    girdles[0].opposite = girdles[1].shoulder;
    girdles[1].opposite = girdles[0].shoulder;
  }
  return girdles;
}

}  // namespace limber
