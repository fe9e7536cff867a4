// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a posable body as glTF 2.0 in one .glb file: the surface of its tissue with the weights of up to four bones
// per vertex, the skeleton at rest, and every clip as an animation. Axes and units are glTF's (glb_writer.h).
//
// Each bone is a node at the bone's head, without rotation at rest, so that the node's rotation is that of the bone in
// a pose. An animation has a key at each frame of its clip. Other programs deform the surface by linear blend skinning,
// as Limber does with the linear blend. The format cannot store a bone's tail, roll and limits.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/motion/clip.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct GltfBody {
  const LabelVolume& volume;
  const TissueTable& tissues;
  const Armature& armature;
  const SkinWeights& weights;
};

struct GltfSettings {
  // Edge length of the cells from which the surface is made, mm. It is rounded to a whole number of voxels, at least
  // one. 0: 1/400 of the volume's longest side.
  double step = 0;
};

// Returns the bytes of the .glb file.
//   clips  written as animations, each from its frame range_start to range_end
// Throws Error if the weights belong to another volume or rig, the volume has no surface, or the file would exceed 4
// GB.
std::string glb_of(const GltfBody& body, const std::vector<std::shared_ptr<const Clip>>& clips,
                   const GltfSettings& settings = {}, Progress& progress = no_progress());
void write_glb(const GltfBody& body, const std::vector<std::shared_ptr<const Clip>>& clips, const Path& path,
               const GltfSettings& settings = {}, Progress& progress = no_progress());

}  // namespace limber
