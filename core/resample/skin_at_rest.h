// SPDX-License-Identifier: AGPL-3.0-or-later
// Determines where the surface of a body at rest is skin, and which tissue must stay covered in a pose. Skin is often
// one voxel thick: a stretch opens it, and the two sides of a seam have none. Tissue that is covered at rest must be
// covered when posed.
//
// In a volume of coarse slices, each slice has skin around it, but the steps between slices have none. When such a body
// is rotated, its surface would need far more skin than there is. So it counts as having open skin: its flesh may lie
// bare, but not tissue from deep inside.
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
  // Keeps references to all arguments.
  SkinAtRest(const LabelVolume& volume, const TissueVoxels& tissue, const TissueDepth& depth, const LabelSet& soft,
             const LabelSet& skin);

  // Returns whether soft tissue from this rest point is covered at rest and must not lie bare when posed.
  bool was_covered(const glm::dvec3& rest_point) const;
  bool was_at_seam(const glm::dvec3& rest_point) const;
  // Returns whether bone from this rest point must get skin over it when it lies bare: bone at a seam, right under
  // closed skin, or deep inside.
  bool was_bone_covered(const glm::dvec3& rest_point) const;
  // Returns the label of the skin that touches the voxel of a rest point; 0 where no skin does, or where the voxel
  // touches air or lies too deep.
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
  // Depths below air, mm: skin is looked for down to skin_reach_, and tissue below deep_ counts as deep.
  double skin_reach_, deep_;
  bool is_closed_;
};

// Turns voxels of the posed volume into skin, each with the label of the skin nearest to it. Voxels without skin within
// 8 voxels stay as they are.
//   returns  the number of changed voxels
std::int64_t cover_with_skin(LabelVolume& posed, std::vector<glm::ivec3> bare, const LabelSet& skin);

// Returns the most common label of `wanted` among the voxels at most `reach` steps from `voxel`; 0 where there is none.
Label most_common_around(const LabelVolume& volume, const glm::ivec3& voxel, int reach, const LabelSet& wanted);

}  // namespace limber
