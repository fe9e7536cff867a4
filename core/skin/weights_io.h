// SPDX-License-Identifier: AGPL-3.0-or-later
// Weights from and to files.
//   W.nrrd   unsigned short, sizes 8 N: bone0-3 then weight0-3 per tissue voxel in brick order; keys `limber_bones` (a
//   JSON
//            list of names), `limber_size` (x y z of the grid) and `limber_tissue_sha256` (of the brick masks), so that
//            weights of another volume are refused. Written raw: 10 MB for the paper's arm, read in a few ms.
//            `limber_seams` holds the seams that they were made with (seam_text.h); without it nobody knows.
//   folder   Bender's weight_00.mha, weight_01.mha ..., one float volume a bone in the rig's order
//   .mha     Bender's hard skin map: per voxel 2 + the bone's place in the rig (1: Bender knew no bone; 0: air)
// Bender's files need not sum to one: on reading they are normalized and rounded to 1/65535, and tissue they leave out
// goes to the rig bone nearest to it, which is said in `warnings`.
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
  // What the weights were made with, null for none; nothing where the file does not say.
  std::optional<std::shared_ptr<const Seams>> seams = {};
};

// Parsed by a process without rights, as volumes are (volume_reader.h).
// Throws Error when the file is damaged, does not belong to this tissue or names a bone that the rig lacks.
WeightsFile read_weights(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue,
                         const Armature& armature);
// Throws Error when no weights can be written under this name.
void check_weights_writable(const Path& path);
// Whether the seams of `tissue` are what the weights were made with, and are written.
enum class SeamsOfWeights { Unknown, OfTissue };
void write_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& path,
                   SeamsOfWeights seams = SeamsOfWeights::Unknown);
// The folder is made if need be.
void write_bender_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                          const Path& folder);

}  // namespace limber
