// SPDX-License-Identifier: AGPL-3.0-or-later
// Locates rigid bones in a pose and finds the shortest motion out of them, so that flesh that blending moves into a
// bone can be pushed out again. Lengths are in mm along the volume's own axes, as in flesh_cells.h.
#pragma once

#include <optional>
#include <vector>

#include "core/deform/depth.h"
#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"

namespace limber {

class PosedBones {
 public:
  // `tissue` and `weights` must outlive this object.
  //   is_bone          1 for each label that is bone tissue
  //   posed_from_rest  motions of the bones of `weights`; each bone voxel follows the first bone of its influence
  PosedBones(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights, const LabelSet& is_bone,
             const std::vector<RigidTransform>& posed_from_rest);

  // Returns the motion that moves a posed point inside a bone to that bone's surface, along the gradient of the depth
  // below that surface; nothing if the point is outside all bones.
  std::optional<glm::dvec3> way_out(const glm::dvec3& posed) const;

 private:
  struct Box {
    int bone;
    glm::ivec3 low, high;  // first and last bin that the box overlaps
  };
  glm::ivec3 bin_of(const glm::dvec3& posed) const { return glm::ivec3(glm::floor((posed - first_) / bin_)); }
  bool holds(int bone, const glm::dvec3& rest) const;
  void fill_bins(const std::vector<Box>& boxes);

  const TissueVoxels* tissue_;
  const SkinWeights* weights_;
  glm::dvec3 spacing_;
  TissueVoxels bone_tissue_;
  std::optional<TissueDepth> depth_;              // depth below the surface of bone tissue, at rest
  std::vector<AffineTransform> rest_from_posed_;  // for each bone, the affine map posed point -> rest point
  std::vector<glm::dmat3> turn_;                  // for each bone, its rotation from rest to the pose
  double bin_ = 0;
  glm::dvec3 first_{0};
  glm::ivec3 bins_{0};
  std::vector<std::int32_t> begin_;  // #bins + 1: index in bones_ of the first bone of each bin
  std::vector<std::int16_t> bones_;  // bones of each bin, ascending
};

}  // namespace limber
