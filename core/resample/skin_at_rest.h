// SPDX-License-Identifier: AGPL-3.0-or-later
// Determines where the surface of a body at rest is skin, and which tissue is covered at rest and so must stay covered
// in a pose. In a pose such tissue may be exposed, because stretch opens skin that is one voxel thick, or because there
// is no skin at a seam (sheet of voxel faces where two limbs touch at rest).
//
// In a volume of coarse slices, each slice has skin around it, but the steps between slices have none. A rotated body
// of this kind would need far more skin than there is to cover its surface. So its skin counts as open: its flesh may
// be exposed in a pose, but tissue from deep inside may not.
#pragma once

#include <unordered_set>
#include <vector>

#include "core/deform/depth.h"
#include "core/resample/air_pockets.h"
#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class SkinAtRest {
 public:
  // Keeps references to all arguments and to the labels of `volume`.
  SkinAtRest(const LabelView& volume, const TissueVoxels& tissue, const TissueDepth& depth, const LabelSet& soft,
             const LabelSet& skin);

  // Returns true if the soft tissue at a rest point is covered at rest, so that it must not lie bare when posed.
  bool was_covered(const glm::dvec3& rest_point) const;
  bool was_at_seam(const glm::dvec3& rest_point) const;
  // Returns true if the bone at a rest point must get skin over it when it lies bare in a pose: it is at a seam, right
  // under closed skin, or deep inside the body.
  bool was_bone_covered(const glm::dvec3& rest_point) const;
  // Returns the label of the skin that touches the voxel at a rest point; 0: no skin does, or the voxel is deep or
  // itself touches air.
  Label skin_over(const glm::dvec3& rest_point) const;

  const std::vector<AirPocket>& air_pockets_at_rest() const { return air_pockets_; }

 private:
  bool touches_outside(const glm::ivec3& voxel) const;
  bool is_deep(const glm::ivec3& voxel) const;
  bool is_bare(const glm::ivec3& voxel) const;
  bool is_mostly_closed() const;

  const LabelView volume_;
  const TissueVoxels& tissue_;
  const TissueDepth& depth_;
  const LabelSet &soft_, &skin_;
  std::vector<AirPocket> air_pockets_;
  std::unordered_set<std::int64_t> enclosed_air_;
  // Depths below air, mm: tissue deeper than skin_reach_ does not touch skin; tissue deeper than deep_ counts as deep.
  double skin_reach_, deep_;
  bool is_closed_;
};

// Turns voxels of the posed volume into skin, each with the label of the skin nearest to it. Voxels without skin within
// 8 voxels stay as they are.
//   returns  the number of changed voxels
std::int64_t cover_with_skin(LabelEdit posed, std::vector<glm::ivec3> bare, const LabelSet& skin);

// Returns the most common label of `wanted` among the voxels at most `reach` steps from `voxel`; 0 where there is none.
Label most_common_around(const LabelView& volume, const glm::ivec3& voxel, int reach, const LabelSet& wanted);

}  // namespace limber
