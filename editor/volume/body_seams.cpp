// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/body_seams.h"

#include "core/bones/bone_map.h"
#include "core/seams/find_seams.h"
#include "core/seams/limbs.h"

namespace limber::editor {

SeamSource seam_source(const Document& document) {
  return {document.volume, document.tissues, document.armature, document.seams, document.bone_map};
}

BoneMap usable_bone_map(const SeamSource& source) {
  return source.bone_map && source.tissues && source.armature
             ? fitting_bone_map(*source.bone_map, *source.tissues, *source.armature).map
             : BoneMap{};
}

bool BodySeams::has_limbs(const std::shared_ptr<const Armature>& armature) {
  const std::lock_guard lock(known_);
  if (asked_ != armature) has_limbs_ = !limbs_of(*armature).empty(), asked_ = armature;
  return has_limbs_;
}

std::optional<std::shared_ptr<const Seams>> BodySeams::known(const SeamSource& source) {
  if (source.kept) return source.kept;
  if (!source.armature || !has_limbs(source.armature)) return nullptr;
  const std::lock_guard lock(known_);
  return source == source_ ? std::optional(seams_) : std::nullopt;
}

std::shared_ptr<const Seams> BodySeams::of(const SeamSource& source, Progress& progress) {
  const std::lock_guard lock(searching_);
  if (const auto seams = known(source)) return *seams;
  const TissueVoxels tissue(*source.volume);
  const BoneParts parts =
      split_bones(*source.volume, tissue, *source.tissues, *source.armature, progress, usable_bone_map(source));
  auto found = std::make_shared<const Seams>(
      find_seams(*source.volume, tissue, *source.tissues, *source.armature, parts, progress));
  const std::lock_guard members(known_);
  source_ = source;
  return seams_ = std::move(found);
}

BodySeams& body_seams() {
  static BodySeams seams;
  return seams;
}

}  // namespace limber::editor
