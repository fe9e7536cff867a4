// SPDX-License-Identifier: AGPL-3.0-or-later
// Where rigid bones lie in a pose, and the way out of them: flesh that blending carries into a bone is pushed out
// again.
//
// Lengths in mm along the volume's own axes, as in flesh_cells.h.
#pragma once

#include <optional>
#include <vector>

#include "core/deform/depth.h"
#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"

namespace limber {

class PosedBones {
 public:
  //   posed_from_rest  by bone of `weights`; bone tissue follows the first bone of its influence     is_bone  by label
  PosedBones(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights, const LabelSet& is_bone,
             const std::vector<RigidTransform>& posed_from_rest);

  // From a posed point inside a bone to that bone's surface, the shortest way as its depth field shows it; none outside
  // all bones.
  std::optional<glm::dvec3> way_out(const glm::dvec3& posed) const;

 private:
  struct Box {
    int bone;
    glm::ivec3 low, high;  // bins
  };
  glm::ivec3 bin_of(const glm::dvec3& posed) const { return glm::ivec3(glm::floor((posed - first_) / bin_)); }
  bool holds(int bone, const glm::dvec3& rest) const;
  void fill_bins(const std::vector<Box>& boxes);

  const TissueVoxels* tissue_;
  const SkinWeights* weights_;
  glm::dvec3 spacing_;
  TissueVoxels bone_tissue_;
  std::optional<TissueDepth> depth_;              // below the surface of bone
  std::vector<AffineTransform> rest_from_posed_;  // by bone
  std::vector<glm::dmat3> turn_;                  // by bone: posed directions of rest directions
  double bin_ = 0;
  glm::dvec3 first_{0};
  glm::ivec3 bins_{0};
  std::vector<std::int32_t> begin_;  // by bin, then one more
  std::vector<std::int16_t> bones_;  // of the bins, rising in each
};

}  // namespace limber
