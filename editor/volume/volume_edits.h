// SPDX-License-Identifier: AGPL-3.0-or-later
// Preparing the volume as jobs, each one edit. What was made for the old volume is kept only while it fits the new one:
// weights while the grid and the tissue's voxels are the same, the rig unless the body was mirrored. What had to go is
// said.
#pragma once

#include <functional>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

struct Preparation {
  std::string label;  // of the job and the edit: "Re-grid to 2 mm"
  std::function<LabelVolume(const LabelVolume& volume, Progress& progress)> change;
  bool mirrors = false;
};
// Needs a volume.
void start_preparation(Editor& editor, Preparation preparation);

// The document with another volume in place of the one that is open. `note` tells what had to go, "" for nothing.
//   same_tissue  the grid and which voxels are tissue are as before
Document with_volume(const Document& now, std::shared_ptr<const LabelVolume> volume, bool same_tissue, bool mirrored,
                     std::string& note);

// "152×50×240"
std::string size_text(const glm::ivec3& size);
// "7 289 600"
std::string grouped(std::int64_t number);

}  // namespace limber::editor
