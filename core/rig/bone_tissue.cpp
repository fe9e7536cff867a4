// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/bone_tissue.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace limber {

namespace {

constexpr double kShareOfRig = 0.6;
constexpr double kEnrichment = 4;
constexpr double kEnds = 0.15;  // of a bone's length at either end, where joints are and no bone tissue need be
constexpr int kMostSamples = 1000;

// mm of the rig in each label; a bone's samples lie at most half a voxel apart, or are kMostSamples.
std::vector<double> length_in(const LabelVolume& volume, const Armature& armature) {
  std::vector<double> length(65536, 0);
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  const double spacing = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  for (const Bone& bone : armature.bones) {
    const double whole = glm::distance(bone.head, bone.tail);
    if (!(whole > 0)) continue;
    const int samples = static_cast<int>(std::clamp(2 * whole / spacing, 1.0, double(kMostSamples)));
    for (int s = 0; s < samples; ++s) {
      const double along = kEnds + (1 - 2 * kEnds) * (s + 0.5) / samples;
      const glm::dvec3 at = glm::floor(to_voxel * glm::mix(bone.head, bone.tail, along) + 0.5);
      const bool inside = glm::all(glm::greaterThanEqual(at, glm::dvec3(0))) && glm::all(glm::lessThan(at, glm::dvec3(volume.grid.size)));
      if (inside) length[volume.at(glm::ivec3(at))] += whole / samples;
    }
  }
  return length;
}

}  // namespace

std::optional<BoneTissueGuess> guess_bone_tissue(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature) {
  const bool something_known = std::any_of(tissues.tissues.begin(), tissues.tissues.end(),
                                           [](const Tissue& tissue) { return tissue.kind != TissueKind::Unknown; });
  if (something_known) return std::nullopt;

  std::vector<double> length = length_in(volume, armature);
  length[0] = 0;
  double in_tissue = 0;
  for (double l : length) in_tissue += l;
  const Label label = static_cast<Label>(std::max_element(length.begin(), length.end()) - length.begin());
  const double share = in_tissue > 0 ? length[label] / in_tissue : 0;
  if (share < kShareOfRig) return std::nullopt;

  std::int64_t own = 0, all = 0;
  for (Label voxel : volume.voxels) {
    own += voxel == label;
    all += voxel != 0;
  }
  if (share * double(all) < kEnrichment * double(own)) return std::nullopt;
  return BoneTissueGuess{label, share};
}

}  // namespace limber
