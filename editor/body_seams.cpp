// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/body_seams.h"

#include "core/bones/bone_parts.h"
#include "core/seams/find_seams.h"
#include "core/seams/limbs.h"

namespace limber::editor {

std::shared_ptr<const Seams> BodySeams::of(const std::shared_ptr<const LabelVolume>& volume, const std::shared_ptr<const TissueTable>& tissues,
                                           const std::shared_ptr<const Armature>& armature, Progress& progress) {
  if (!armature || limbs_of(*armature).empty()) return nullptr;
  const std::lock_guard lock(mutex_);
  if (volume == volume_ && tissues == tissues_ && armature == armature_) return seams_;
  const TissueVoxels tissue(*volume);
  const BoneParts parts = split_bones(*volume, tissue, *tissues, *armature, progress);
  auto found = std::make_shared<const Seams>(find_seams(*volume, tissue, *tissues, *armature, parts, progress));
  volume_ = volume;
  tissues_ = tissues;
  armature_ = armature;
  return seams_ = std::move(found);
}

BodySeams& body_seams() {
  static BodySeams seams;
  return seams;
}

}  // namespace limber::editor
