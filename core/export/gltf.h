// SPDX-License-Identifier: AGPL-3.0-or-later
// A posable body as glTF 2.0, all in one .glb file: the surface of its tissue with up to four bones a vertex, the
// skeleton at rest, and every clip as an animation. Axes and units are glTF's [core/export/glb_writer.h].
//
// Every bone is a node at its head, without a rotation at rest, so that a pose's rotations are the nodes'
// own; a clip sets a key at each of its frames. Other programs blend linearly between bones, as our linear blend does.
// A bone's tail, roll and limits have no place in the format.
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
  double step =
      0;  // mm, of the cells whose surface is taken, the volume's voxels at least; 0: 1/400 of its longest side
};

// The bytes of the file.
//   clips  what each plays from range_start to range_end
// Throws Error for weights of another volume or rig, for a volume that has no surface, for more than 4 GB.
std::string glb_of(const GltfBody& body, const std::vector<std::shared_ptr<const Clip>>& clips,
                   const GltfSettings& settings = {}, Progress& progress = no_progress());
void write_glb(const GltfBody& body, const std::vector<std::shared_ptr<const Clip>>& clips, const Path& path,
               const GltfSettings& settings = {}, Progress& progress = no_progress());

}  // namespace limber
