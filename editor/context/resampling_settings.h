// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "core/resample/deformation_method.h"

namespace limber::editor {

struct ResamplingSettings {
  std::string method = deformation_methods().front().word;
  double spacing = 0;        // voxel size of the posed volume, mm; 0: as in the volume at rest
  bool bones_apart = false;  // true: joints may shift by more than a voxel so that bones do not overlap
  bool mass_exact = false;   // true: each soft tissue keeps its volume, exact to a voxel
  // Options of the method "finite elements"
  bool contact = true;
  std::string quality = "normal";  // quality of the FEM mesh: "draft", "normal" or "fine"

  bool operator==(const ResamplingSettings&) const = default;
};

}  // namespace limber::editor
