// SPDX-License-Identifier: AGPL-3.0-or-later
// Provides the seams of the open document: the surfaces between different limbs that touch at rest, such as hand and
// thigh. If the document stores no seams, they are computed once for the volume, its tissues and its rig. Previews,
// live measurements and weights use seams. Any thread may call these functions; while one thread searches for seams,
// other threads wait for its result.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "core/base/progress.h"
#include "core/project/document.h"

namespace limber::editor {

// The data that the seams depend on. Equal pointers mean equal contents.
struct SeamSource {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const Armature> armature;
  // Seams stored in the document; null: none are stored, so seams must be found.
  std::shared_ptr<const Seams> kept;
  // User's choice of the rig bone that each bone label follows; null: no choice.
  std::shared_ptr<const BoneMap> bone_map;

  bool operator==(const SeamSource&) const = default;
};
SeamSource seam_source(const Document& document);
// Returns the entries of the document's bone map whose tissue and rig bone exist in the document; an empty map if the
// document has no bone map.
BoneMap usable_bone_map(const SeamSource& source);

class BodySeams {
 public:
  // Returns the seams; finds them first if needed. Returns null if the document has no seams of its own and limbs
  // cannot be told apart: it has no rig, or a rig whose bone names do not say which bones are limbs.
  std::shared_ptr<const Seams> of(const SeamSource& source, Progress& progress = no_progress());
  // Returns the seams as of() does, but never searches for seams. Returns nothing if a search is needed.
  std::optional<std::shared_ptr<const Seams>> known(const SeamSource& source);
  // Returns whether the rig has bones whose names say that they belong to arms, legs or fingers. Computed once per rig.
  bool has_limbs(const std::shared_ptr<const Armature>& armature);

 private:
  std::mutex searching_, known_;  // searching_: locked during a search for seams; known_: guards the members below
  std::shared_ptr<const Armature> asked_;
  bool has_limbs_ = false;
  SeamSource source_;
  std::shared_ptr<const Seams> seams_;
};

// Returns the only instance: the program has one editor with one document.
BodySeams& body_seams();

}  // namespace limber::editor
