// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes files of weights.
//   W.nrrd   unsigned short, sizes 8 N: bone0-3, then weight0-3 per tissue voxel in brick order. Written without
//            compression: 10 MB for the paper's arm, read in a few ms. Three keys serve to refuse weights of another
//            volume: `limber_bones` (a JSON list of names), `limber_size` (x y z of the grid) and
//            `limber_tissue_sha256` (hash of the brick masks, which tell where tissue is). The key `limber_seams` has
//            the seams (cuts between touching tissue) that the weights were computed with (seam_text.h); without this
//            key they are unknown.
//   folder   Bender's weight_00.mha, weight_01.mha ..., one float volume per bone, in the rig's order
//   .mha     Bender's hard skin map: per voxel 2 + the bone's index in the rig (1: no bone known; 0: air)
// Bender's weights need not sum to one, so they are normalized and rounded to 1/65535 when they are read. Tissue to
// which the files give no weight follows the nearest bone of the rig, and `warnings` says so.
#pragma once

#include <memory>
#include <optional>

#include "core/base/file.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct WeightsFile {
  SkinWeights weights;
  std::vector<std::string> warnings;
  // The seams with which the weights were computed. Empty: the file does not say; null: without seams.
  std::optional<std::shared_ptr<const Seams>> seams = {};
};

// Reads weights from a file or a folder. A separate process without rights parses the file, as for volumes
// (volume_reader.h). Throws Error when the file is damaged, does not belong to this tissue or names a bone that the rig
// does not have.
WeightsFile read_weights(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue,
                         const Armature& armature);
// Throws Error when no weights can be written to this path.
void check_weights_writable(const Path& path);
// Tells whether the weights were computed with the seams of `tissue`. The file stores seams only for OfTissue.
enum class SeamsOfWeights { Unknown, OfTissue };
void write_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& path,
                   SeamsOfWeights seams = SeamsOfWeights::Unknown);
// Writes one volume per bone, in Bender's format. Creates the folder if needed.
void write_bender_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                          const Path& folder);

}  // namespace limber
