// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives a body a closed skin, one voxel thick. In phantoms that were segmented slice by slice, skin surrounds the flesh
// within every slice but is missing on its upper and lower faces, so shoulders and soles are bare. Skin is closed when
// no flesh other than skin shares a voxel face with outside air. The share of the surface that is skin is counted in
// the same way (report/metrics.h).
//
// Outside air is what outside_air() finds; air inside the body stays unchanged. Bone keeps its labels, and so do nails
// and air-filled cavities (less dense than tissue), which may naturally touch the air.
//
// Tissue at a face of the volume was either cut there (a torso without its legs) or only touches the face, as a
// shoulder in a volume that was cropped to the body. Tissue that was cut gets no skin at the cut; tissue that only
// touches gets skin. A connected component of tissue in the outermost layer of voxels only touches when it contains no
// bone and has at most kTouchShare times as many voxels as the tissue that continues it in the next layer. A flat sole
// looks like a cut, so pad the volume first.
#pragma once

#include <array>
#include <optional>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

enum class SkinGrowth {
  Inward,   // the outermost voxels of flesh become skin
  Outward,  // the air voxels beside the outermost voxels of flesh become skin
};

constexpr double kTouchShare = 0.6;

struct ClosedSkin {
  LabelVolume volume;
  std::int64_t changed_voxels = 0;
  // Number of voxels that touched outside air, for each label 0 .. 65535. With SkinGrowth::Inward these voxels became
  // skin; with Outward the air beside them did.
  std::vector<std::int64_t> covered;
  std::int64_t bare_bone_voxels = 0;  // with Inward: bone voxels at outside air, which stay bone
  // Number of voxels other than skin where the body was cut at a face of the volume: lowest x, highest x, lowest y ...
  std::array<std::int64_t, 6> cut{};
  bool is_padded = false;            // with Outward: the volume was padded by one voxel on every side to hold the skin
  std::int64_t enclosed_voxels = 0;  // with Outward: voxels of outside air that the new skin encloses
};

// Closes the skin. Each new skin voxel gets the label of the nearest skin voxel, counted in steps through tissue. When
// no skin is connected to it, it gets the skin label with the most voxels.
//   skin_label  label of all new skin, whatever its kind in the table
//   throws Error when no label is given and the table names no skin, or several of which none is in the volume
ClosedSkin close_skin(const LabelVolume& volume, const TissueTable& tissues, SkinGrowth growth,
                      std::optional<Label> skin_label = {});

}  // namespace limber
