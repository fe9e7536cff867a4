// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives a body a closed skin of one voxel. In phantoms that were drawn slice by slice, skin surrounds every slice and
// leaves the steps between slices open: shoulders and soles lie bare. Skin is closed when no flesh but skin shares a
// face with outside air, as the share of the surface that is skin is counted (report/metrics.h).
//
// Outside is what outside_air() finds; air inside the body stays what it is. Bone keeps its labels, and so do nails and
// cavities that hold air (less dense than tissue), which may lie at the air by nature.
//
// The volume's border is no air. Tissue that lies at it was cut there (a torso without its legs), and stays open at the
// cut; but where it only just touches the border, as a shoulder in a volume that was cropped to the body, it ends
// there. A piece of tissue in the outermost layer touches when it holds no bone and is at most kTouchShare as large as
// what continues it in the next layer. A flat sole looks like a cut; padding the volume before says that it is none.
#pragma once

#include <array>
#include <optional>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

enum class SkinGrowth {
  Inward,   // the outermost voxels of flesh become skin
  Outward,  // the voxels of air beside them become skin
};

constexpr double kTouchShare = 0.6;

struct ClosedSkin {
  LabelVolume volume;
  std::int64_t changed_voxels = 0;
  std::vector<std::int64_t> covered;  // [65536] voxels by label that lay at the air: inward they became skin, outward
                                      // they got some beside them
  std::int64_t bare_bone_voxels = 0;  // inward: bone at the outside air, which stays as it is
  std::array<std::int64_t, 6>
      cut{};  // voxels other than skin at the border where the body is cut: lowest x, highest x, lowest y ...
  bool is_padded = false;            // outward: the volume was grown by a voxel on every side to hold the skin
  std::int64_t enclosed_voxels = 0;  // outward: air that the new skin shuts in
};

// New skin has the label of the skin that is the fewest steps through tissue away; where none is connected, of the skin
// with the most voxels.
//   skin_label  new skin has this label, whatever kind the table gives it
//   throws Error when no label is given, and the table names no skin, or several of which none is in the volume
ClosedSkin close_skin(const LabelVolume& volume, const TissueTable& tissues, SkinGrowth growth,
                      std::optional<Label> skin_label = {});

}  // namespace limber
