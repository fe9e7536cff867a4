// SPDX-License-Identifier: AGPL-3.0-or-later
// Prepares the volume, for example by cropping it. Each preparation runs as a job and makes one edit. Weights are kept
// only if the grid and the set of tissue voxels stay the same; the rig is kept unless the body was mirrored. A message
// tells the user what was removed.
#pragma once

#include <functional>
#include <string>

#include "core/project/document.h"

namespace limber::editor {

struct Context;

struct Preparation {
  std::string label;  // the name of the job and of the edit: "Resize voxels to 2 mm"
  std::function<LabelVolume(const LabelVolume& volume, Progress& progress)> change;
  bool mirrors = false;
};
// Starts a job that prepares the volume. The document must have a volume.
void start_preparation(Context& context, Preparation preparation);

// Returns the document with another volume in place of its own. Weights, rig and seams are removed if they do not fit
// the new volume. `note` receives a message that says what was removed, or "".
//   same_tissue  true if the new volume has the same grid as the old one, and tissue in the same voxels
//   mirrored     true if the new volume is a mirror image of the old one: rig and measurements are removed
Document with_volume(const Document& now, std::shared_ptr<const LabelVolume> volume, bool same_tissue, bool mirrored,
                     std::string& note);

// Returns a size as text such as 152x50x240, with multiplication signs in place of x.
std::string size_text(const glm::ivec3& size);
// Returns a number as text with its digits in groups of three, such as "7 289 600".
std::string grouped(std::int64_t number);

}  // namespace limber::editor
