// SPDX-License-Identifier: AGPL-3.0-or-later
// One body of a study or batch, as the description file states it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"

namespace limber {

struct DescribedBody {
  std::string name;
  std::string phantom;  // "arm", "body", or empty for a body in files
  Path volume, rig, tissues, bone_map, seams;
  std::vector<double> bones;      // labels of bone, as values in the volume's file; empty: those of the tissue table
  std::optional<double> spacing;  // voxel spacing to resample the volume to, mm; empty: the volume's own
  std::string weights = "heat";   // how skin weights are computed: a word of binding_words()
  Path weights_file;              // file with existing skin weights; empty: they are computed
  bool no_seams = false;          // true: tissue that touches in the volume counts as connected
  Path grey, landmarks;           // files of a grey volume and of landmarks that are posed with the body; empty: none
};

}  // namespace limber
