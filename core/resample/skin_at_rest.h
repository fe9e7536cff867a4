// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of a body at rest, as posing has to keep it: where it is skin, and what may not come to lie bare. Skin is
// often one voxel thick; a stretch opens it, and the two sides of a seam have none. What was covered at rest is covered
// when posed.
//
// Coarse slices have skin around each of them and none on their steps; turned, their surface would need far more skin
// than there is. Such a body has open skin, and flesh may lie bare as it did, but not what was deep inside.
#pragma once

#include <unordered_set>
#include <vector>

#include "core/deform/depth.h"
#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class SkinAtRest {
 public:
  // References are kept.
  SkinAtRest(const LabelVolume& volume, const TissueVoxels& tissue, const TissueDepth& depth, const LabelSet& soft,
             const LabelSet& skin);

  // Whether tissue that comes from this rest point must not lie bare when posed.
  bool was_covered(const glm::dvec3& rest_point) const;
  bool was_at_seam(const glm::dvec3& rest_point) const;
  // The same for bone, which stays bone: it gets skin beside it where it lay at a seam, right under closed skin, or
  // deep inside.
  bool was_bone_covered(const glm::dvec3& rest_point) const;
  // The skin that touches the rest point's voxel, 0 where there is none or the voxel lies deeper than skin can be.
  Label skin_over(const glm::dvec3& rest_point) const;

 private:
  bool touches_outside(const glm::ivec3& voxel) const;
  bool is_deep(const glm::ivec3& voxel) const;
  bool is_bare(const glm::ivec3& voxel) const;
  bool is_mostly_closed() const;

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  const TissueDepth& depth_;
  const LabelSet &soft_, &skin_;
  std::unordered_set<std::int64_t> enclosed_air_;
  double skin_reach_, deep_;  // mm below air
  bool is_closed_;
};

// Makes skin of voxels of the posed volume, each of the kind that the skin nearest to it has; those stay what they are
// that have none within a few voxels.
//   returns  the voxels changed
std::int64_t cover_with_skin(LabelVolume& posed, std::vector<glm::ivec3> bare, const LabelSet& skin);

// The label of `wanted` that most voxels around `voxel` have, at most `reach` steps away; 0 where none has one.
Label most_common_around(const LabelVolume& volume, const glm::ivec3& voxel, int reach, const LabelSet& wanted);

}  // namespace limber
