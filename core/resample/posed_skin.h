// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the skin of a posed volume closed and thin. Voxels are given by their index in the volume, x fastest.
#pragma once

#include <vector>

#include "core/volume/label_sampler.h"

namespace limber {

// A posed voxel of soft tissue or bone that is covered at rest and may lie bare in the pose.
struct UnderSkin {
  std::int64_t at;  // index in the posed volume
  Label skin;       // label of the skin that touches it at rest; 0: it lies deeper or at a seam
};

// A posed voxel of skin that does not touch air.
struct InnerSkin {
  float depth;      // mm below air at rest
  std::int64_t at;  // index in the posed volume
};

// Closes holes in the skin: a bare voxel that lies under skin at rest becomes skin. Skin is often one voxel thick, so
// the grid or a stretch opens it.
//   flesh    soft tissues without skin, by label
//   returns  the number of changed voxels
std::int64_t close_skin(LabelVolume& posed, const std::vector<UnderSkin>& under_skin, const LabelSet& flesh);

// Thins the skin to compensate for the voxels that close_skin added to it. Where the grid made the skin two voxels
// thick, its deepest voxels become the tissue around them.
//   inner_skin  sorted by this function
//   returns     the number of changed voxels, at most `most`
std::int64_t thin_skin(LabelVolume& posed, std::vector<InnerSkin>& inner_skin, std::int64_t most, const LabelSet& flesh,
                       const LabelSet& skin);

// Restores skin where flesh that was covered at rest is exposed in the pose, because a seam has opened or strong
// stretching has torn the skin: the outermost flesh voxels become skin. Exposed bone that at rest was at a seam, under
// closed skin or deep in the body is covered too: the air voxels next to it become skin. Flesh and bone next to
// enclosed air (lungs, bowel) are not changed.
//   was_air  receives, appended, the voxels changed from air to skin
//   returns  the number of changed voxels
std::int64_t cover_bare_flesh(LabelVolume& posed, const std::vector<UnderSkin>& under_skin, const LabelSet& flesh,
                              const LabelSet& bone, const LabelSet& skin, std::vector<glm::ivec3>& was_air);

}  // namespace limber
