// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/place_in_tissue.h"

#include <algorithm>
#include <cmath>

#include "core/autorig/place_rig.h"
#include "core/motion/body_frame.h"

namespace limber {

namespace {

constexpr double kSure = 0.5;     // a joint whose confidence is at least this counts as found for certain
constexpr double kBetter = 1.02;  // another rotation is used only if it fits better by this factor

// Returns the 24 rotations by right angles: first the identity, then the others that keep the vertical axis, then the
// rest.
std::vector<glm::dmat3> right_turns() {
  std::vector<glm::dmat3> turns;
  for (int z = 0; z < 3; ++z)
    for (double up : {1.0, -1.0})
      for (int x = 0; x < 3; ++x)
        for (double side : {1.0, -1.0}) {
          if (x == z) continue;
          glm::dvec3 third(0), first(0);
          third[z] = up;
          first[x] = side;
          turns.push_back(glm::transpose(glm::dmat3(first, glm::cross(third, first), third)));
        }
  std::stable_sort(turns.begin(), turns.end(), [](const glm::dmat3& a, const glm::dmat3& b) {
    const auto nearness = [](const glm::dmat3& turn) { return 4 * turn[2][2] + turn[0][0] + turn[1][1]; };
    return nearness(a) > nearness(b);
  });
  return turns;
}

// Returns the unit direction from the feet to the head of a rig; none if the names of its bones do not show this
// direction.
std::optional<glm::dvec3> line_of(const Armature& rig) {
  const Skeleton skeleton = skeleton_of(rig);
  const auto trunk = trunk_line(skeleton);
  return trunk ? std::optional(glm::normalize(*trunk)) : std::nullopt;
}

// Returns a measure of how well a rig fits: the length of its bones in tissue, times the share of its whole length in
// tissue. The first factor rejects a rig so small that it fits anywhere, the second one a rig that is larger than the
// body.
double suits(const RigCheck& check, const Armature& rig) {
  double length = 0;
  for (const Bone& bone : rig.bones) length += glm::distance(bone.head, bone.tail);
  return check.whole * check.whole * length;
}

}  // namespace

Armature placed_in_tissue(const LabelVolume& volume, const Armature& rig) {
  const auto line = line_of(rig);
  Armature best = scaled_to_tissue(volume, rig);
  double most = 0;
  for (const glm::dmat3& turn : right_turns()) {
    if (line && (turn * *line).z < std::sqrt(0.5)) continue;
    const Armature placed = scaled_to_tissue(volume, moved_rig(rig, turn, 1, glm::dvec3(0), glm::dvec3(0)));
    const double suited = suits(check_rig(volume, placed), placed);
    if (suited > kBetter * most) most = suited, best = placed;
  }
  return best;
}

AutoFit fitted_or_placed(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig,
                         Progress& progress) {
  AutoFit fitted = auto_fit(volume, tissues, rig, progress);
  if (std::any_of(fitted.joints.begin(), fitted.joints.end(),
                  [](const JointFit& joint) { return joint.confidence >= kSure; }))
    return fitted;
  AutoFit placed{.armature = placed_in_tissue(volume, rig)};
  placed.check = check_rig(volume, placed.armature);
  if (suits(placed.check, placed.armature) <= suits(fitted.check, fitted.armature)) return fitted;
  placed.joints.assign(rig.bones.size(), {JointFit::How::Extents, 0.1, error_by_extents(volume)});
  placed.warnings = {
      "no joint could be found with confidence: the rig was only placed and scaled to the tissue; move its joints by "
      "hand, or give its bones anatomical names"};
  return placed;
}

}  // namespace limber
