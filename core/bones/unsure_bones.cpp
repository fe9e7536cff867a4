// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/unsure_bones.h"

#include <algorithm>

#include "core/rig/joint_names.h"

namespace limber {

namespace {
// Returns true if one of the cuts lies at a knee, according to the names of the rig bones.
bool has_knee(const std::vector<BroadCut>& cuts, const Armature& armature) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) names.push_back(bone.name), parents.push_back(bone.parent);
  const auto roles = joint_roles(names, parents);
  return std::any_of(cuts.begin(), cuts.end(), [&](const BroadCut& cut) {
    const auto &upper = roles[cut.bone], &lower = roles[cut.other];
    return upper && lower && upper->part == BodyPart::Thigh && lower->part == BodyPart::Shank;
  });
}
}  // namespace

std::vector<std::string> unsure_bones(const BoneParts& parts, const TissueTable& tissues, const Armature& armature) {
  std::vector<std::string> lines;
  for (const BoneParts::Identity& identity : parts.identities) {
    const Tissue* tissue = tissues.find(identity.label);
    if (!identity.is_substitute || !tissue) continue;
    lines.push_back("the rig has no bone for \"" + tissue->name.substr(0, 80) + "\": the label follows " +
                    armature.bones[identity.bone].name + "; set another bone with --bone-map");
  }
  if (const std::vector<BroadCut>& cuts = parts.broad_cuts; !cuts.empty()) {
    const BroadCut& broadest = *std::max_element(cuts.begin(), cuts.end(),
                                                 [](const BroadCut& a, const BroadCut& b) { return a.area < b.area; });
    const std::string others = cuts.size() == 1 ? ""
                                                : " and at " + std::to_string(cuts.size() - 1) + " other joint" +
                                                      (cuts.size() == 2 ? "" : "s");
    lines.push_back("bones that share one label touch over a large area between " + armature.bones[broadest.bone].name +
                    " and " + armature.bones[broadest.other].name + others +
                    ": the cut between them may be off by one or two voxels" +
                    (has_knee(cuts, armature) ? ", and the tip of a kneecap may follow the shank" : "") +
                    "; give each bone its own label if this matters");
  }
  return lines;
}

}  // namespace limber
