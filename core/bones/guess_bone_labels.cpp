// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/guess_bone_labels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace limber {

namespace {

// Share of a rig bone's length at each end that is not examined, since joints are there and bone tissue may be missing.
constexpr double kEnds = 0.15;
// Radii of regions around a rig bone's axis, as shares of the rig bone's length: the region "beside" the axis ends at
// kBeside, the region "around" it extends from kAroundFrom to kAroundTo. A rig may run beside the real bone by half the
// limb's thickness, and limbs are about 0.15 thick.
constexpr double kBeside = 0.09, kAroundFrom = 0.11, kAroundTo = 0.19;
// A label counts as present beside a rig bone if at least this share of the points beside the bone's axis has this
// label.
constexpr double kLeastOfDisc = 0.05;
// Lower limits for a label that counts as bone. kShareOfRig: share of the rig's length that has the label beside it.
// kEnrichment: ratio of the label's frequency beside the axis to its frequency around the axis. Measured bone had
// shares of 0.5 to 0.94 and ratios of 30 or more. Other labels with a ratio of 8 had shares up to 0.33, those with a
// share of 0.4 had ratios up to 5.
constexpr double kShareOfRig = 0.4, kEnrichment = 8;
// Rig bones shorter than this share of the longest rig bone are not examined. Short bones are as thick as long, so that
// the tissue beside and around them does not differ.
constexpr double kLong = 0.5;
constexpr int kSlices = 60, kPoints = 120;  // slices across each rig bone, and sampled points in each slice

struct Lengths {
  double in_tissue = 0;
  std::map<Label, double> with;  // for each label, length of the rig bones that have the label beside them, mm
  // For each label: length of the rig bones, weighted by the label's share of the tissue beside the bones or around
  // them, mm.
  std::map<Label, double> beside, around;
};

// Returns evenly spread points of a disc of radius 1, in the pattern of a sunflower's head [Vogel 1979].
std::vector<glm::dvec2> disc() {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<glm::dvec2> points;
  for (int k = 0; k < kPoints; ++k)
    points.push_back(std::sqrt((k + 0.5) / kPoints) * glm::dvec2(std::cos(k * golden), std::sin(k * golden)));
  return points;
}

Lengths lengths_of(const LabelVolume& volume, const Armature& armature) {
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  const auto label_at = [&](const glm::dvec3& place) -> Label {
    const glm::dvec3 at = glm::floor(to_voxel * place + 0.5);
    const bool inside =
        glm::all(glm::greaterThanEqual(at, glm::dvec3(0))) && glm::all(glm::lessThan(at, glm::dvec3(volume.grid.size)));
    return inside ? volume.at(glm::ivec3(at)) : Label(0);
  };
  const std::vector<glm::dvec2> points = disc();
  Lengths lengths;
  double longest = 0;
  for (const Bone& bone : armature.bones) longest = std::max(longest, glm::distance(bone.head, bone.tail));
  for (const Bone& bone : armature.bones) {
    const double whole = glm::distance(bone.head, bone.tail), slice = whole / kSlices;
    if (!(whole > 0) || whole < kLong * longest) continue;
    const glm::dvec3 axis = (bone.tail - bone.head) / whole;
    const glm::dvec3 u = glm::normalize(
                         glm::cross(axis, std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))),
                     v = glm::cross(axis, u);
    for (int s = 0; s < kSlices; ++s) {
      const glm::dvec3 centre = glm::mix(bone.head, bone.tail, kEnds + (1 - 2 * kEnds) * (s + 0.5) / kSlices);
      if (label_at(centre) == 0) continue;
      lengths.in_tissue += slice;
      std::map<Label, int> beside, around;
      int near = 0, far = 0;
      for (const glm::dvec2& point : points) {
        const glm::dvec2 p = kAroundTo * point;
        const double off = glm::length(p);
        if (off > kBeside && off < kAroundFrom) continue;
        const Label label = label_at(centre + whole * (p.x * u + p.y * v));
        if (label == 0) continue;
        if (off <= kBeside) ++beside[label], ++near;
        else ++around[label], ++far;
      }
      for (const auto& [label, count] : beside) {
        lengths.beside[label] += slice * count / near;
        if (count >= kLeastOfDisc * near) lengths.with[label] += slice;
      }
      for (const auto& [label, count] : around) lengths.around[label] += slice * count / far;
    }
  }
  return lengths;
}

}  // namespace

std::optional<BoneTissueGuess> guess_bone_tissue(const LabelVolume& volume, const TissueTable& tissues,
                                                 const Armature& armature) {
  const bool something_known = std::any_of(tissues.tissues.begin(), tissues.tissues.end(),
                                           [](const Tissue& tissue) { return tissue.kind != TissueKind::Unknown; });
  if (something_known) return std::nullopt;

  const Lengths lengths = lengths_of(volume, armature);
  std::optional<BoneTissueGuess> best;
  for (const auto& [label, length] : lengths.with) {
    const auto around = lengths.around.find(label);
    if (around != lengths.around.end() && lengths.beside.at(label) < kEnrichment * around->second) continue;
    const double share = length / lengths.in_tissue;
    if (share >= kShareOfRig && (!best || share > best->share_of_rig)) best = BoneTissueGuess{label, share};
  }
  return best;
}

}  // namespace limber
