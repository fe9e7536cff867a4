// SPDX-License-Identifier: AGPL-3.0-or-later
// The seams of the body that is open, found once for a volume, its tissues and its rig, whoever asks: previews, live figures,
// weights. Any thread may ask; one that asks while another searches waits for it.
#pragma once

#include <memory>
#include <mutex>

#include "core/base/progress.h"
#include "core/rig/armature.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_table.h"

namespace limber::editor {

class BodySeams {
 public:
  // Null where there is no rig, or its bones' names mean no limbs. Equal pointers are equal contents.
  std::shared_ptr<const Seams> of(const std::shared_ptr<const LabelVolume>& volume, const std::shared_ptr<const TissueTable>& tissues,
                                  const std::shared_ptr<const Armature>& armature, Progress& progress = no_progress());

 private:
  std::mutex mutex_;
  std::shared_ptr<const LabelVolume> volume_;
  std::shared_ptr<const TissueTable> tissues_;
  std::shared_ptr<const Armature> armature_;
  std::shared_ptr<const Seams> seams_;
};

// Of the program: a document is open in one editor.
BodySeams& body_seams();

}  // namespace limber::editor
