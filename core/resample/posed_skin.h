// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the skin of a posed volume closed and thin. Voxels are told by their place in the volume, x fastest.
#pragma once

#include <vector>

#include "core/volume/label_sampler.h"

namespace limber {

// A posed voxel of soft tissue, maybe bare, that was covered at rest.
struct UnderSkin {
  std::int64_t at;
  Label skin;  // what lay right over it at rest; 0 where it lay deeper, or a seam
};

// A posed voxel of skin that is covered itself.
struct InnerSkin {
  float depth;  // mm below air at rest
  std::int64_t at;
};

// Skin is often one voxel thick; where the grid or a stretch opens it, what lay under it is skin now.
//   flesh    soft tissues but skin, by label
//   returns  the voxels changed
std::int64_t close_skin(LabelVolume& posed, const std::vector<UnderSkin>& under_skin, const LabelSet& flesh);

// Where skin was closed it gained voxels, and elsewhere the grid laid some of it two voxels thick: the deepest of
// those go to the tissue that lies around them, as many as were gained.
//   inner_skin  is sorted
//   returns     the voxels changed, at most `most`
std::int64_t thin_skin(LabelVolume& posed, std::vector<InnerSkin>& inner_skin, std::int64_t most, const LabelSet& flesh,
                       const LabelSet& skin);

// Where a seam opens or a stretch goes deeper, flesh lies bare that was covered at rest: its outermost voxels are skin
// now. Bone that lay at a seam, under closed skin or deep inside gets skin over it. Nothing changes at air that the
// body encloses.
//   was_air  what had no tissue before is added
//   returns  the voxels changed
std::int64_t cover_bare_flesh(LabelVolume& posed, const std::vector<UnderSkin>& under_skin, const LabelSet& flesh,
                              const LabelSet& bone, const LabelSet& skin, std::vector<glm::ivec3>& was_air);

}  // namespace limber
