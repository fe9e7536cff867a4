// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives a body a closed skin, one voxel thick. In volumes that were segmented slice by slice, skin surrounds the flesh
// within every slice but is missing where the body's surface faces up or down, so shoulders and soles are bare. Skin is
// closed if no flesh other than skin shares a voxel face with the air around the body. The metric for the share of the
// surface that is skin (report/metrics.h) uses the same definition.
//
// outside_air() finds the air around the body; air inside the body stays unchanged. Bone, nails and air-filled cavities
// (less dense than tissue) keep their labels. Nails and cavities may naturally touch the air.
//
// Tissue at a face of the volume was either cut there (a torso without its legs), or it only touches the face (a
// shoulder in a volume that was cropped to the body). Tissue that was cut gets no skin at the cut. Tissue counts as
// touching if its connected component in the outermost layer of voxels contains no bone, and has at most kTouchShare
// times as many voxels as the tissue that continues it in the next layer. Flat soles look like a cut, so pad the volume
// first.
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
  // For each label 0 .. 65535, the number of its voxels that touched the air around the body. With SkinGrowth::Inward
  // these voxels became skin; with Outward the air voxels beside them became skin.
  std::vector<std::int64_t> covered;
  std::int64_t bare_bone_voxels = 0;  // number of bone voxels that touch the air around the body and stay bone (Inward)
  // Number of voxels, skin excluded, at which each face of the volume cuts the body. The faces are in the order lowest
  // x, highest x, lowest y ...
  std::array<std::int64_t, 6> cut{};
  bool is_padded = false;  // true: the volume was padded by one voxel on every side to hold the skin (Outward)
  std::int64_t enclosed_voxels = 0;  // number of voxels of surrounding air that the new skin encloses (Outward)
};

// Closes the skin. If several labels are skin, each new skin voxel gets the label of the nearest skin voxel, counted in
// steps through tissue. If no such path leads to skin, the voxel gets the skin label with the most voxels. Throws Error
// if `skin_label` is empty and the table has no skin, or has several kinds of skin none of which is in the volume.
//   skin_label  label of all new skin; need not be skin in the table
ClosedSkin close_skin(const LabelVolume& volume, const TissueTable& tissues, SkinGrowth growth,
                      std::optional<Label> skin_label = {});

}  // namespace limber
