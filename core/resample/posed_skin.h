// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the skin of a posed volume closed and thin. Voxel indices count x fastest.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/resample/air_pockets.h"
#include "core/volume/label_sampler.h"

namespace limber {

// A posed voxel of soft tissue or bone that may touch air in the pose, although it is covered at rest (SkinAtRest).
struct UnderSkin {
  std::int64_t at;  // index of the voxel in the posed volume
  Label skin;       // label of the skin that touches the tissue at rest; 0: none does
};

// Removes the voxels that touch no air from a list of candidates. The list grows while the posed volume is written
// layer by layer along z. Slices that are not written yet look like air, so voxels in the newest layer are checked
// again in the next call.
//   unsure   the value that the last call returned; 0 in the first call
//   low      lowest slice of the newest layer
//   returns  index of the first voxel that the next call must check
std::ptrdiff_t drop_covered(const LabelView& posed, std::vector<UnderSkin>& under_skin, std::ptrdiff_t unsure, int low);

// A posed voxel of skin that does not touch air. A fine body has millions of them, so they are stored in 12 bytes.
struct InnerSkin {
  float depth;                         // distance to the nearest air at rest, mm
  std::array<std::uint16_t, 3> voxel;  // position of the voxel in the posed volume
};

// Closes holes in the skin: a flesh voxel that touches air but lies under skin at rest becomes skin. Skin gets holes
// because it is often only one voxel thick, so that rotation on the grid or stretch opens it.
//   flesh    soft tissues without skin, by label
//   returns  the number of changed voxels
std::int64_t close_skin(LabelEdit posed, const std::vector<UnderSkin>& under_skin, const LabelSet& flesh);

// Thins the skin to compensate for the voxels that close_skin() added. Rotation on the grid makes skin two voxels thick
// in places; the deepest skin voxels there get the most common flesh around them.
//   inner_skin  in any order; is reordered
//   most        upper limit on the number of changed voxels
//   returns     the number of changed voxels
std::int64_t thin_skin(LabelEdit posed, std::vector<InnerSkin>& inner_skin, std::int64_t most, const LabelSet& flesh,
                       const LabelSet& skin);

// Restores skin where a seam (sheet of voxel faces where two limbs touch at rest) has opened or strong stretching has
// torn the skin. Flesh that was covered at rest and touches air becomes skin. Bone that touches air, but was at a seam,
// under closed skin or deep in the body at rest, is covered: the air voxels next to it become skin. Flesh and bone next
// to enclosed air (lungs, bowel) are not changed.
//   enclosed  air pockets that hold all enclosed air of `posed`; some of their voxels may be filled since
//   was_air   out: the voxels changed from air to skin are appended
//   returns   the number of changed voxels
std::int64_t cover_bare_flesh(LabelEdit posed, const std::vector<AirPocket>& enclosed,
                              const std::vector<UnderSkin>& under_skin, const LabelSet& flesh, const LabelSet& bone,
                              const LabelSet& skin, std::vector<glm::ivec3>& was_air);

}  // namespace limber
