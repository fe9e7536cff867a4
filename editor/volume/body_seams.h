// SPDX-License-Identifier: AGPL-3.0-or-later
// The seams of the body that is open: those that its document keeps, else those that are found, once for a volume, its
// tissues and its rig, whoever asks: previews, live figures, weights. Any thread may ask; one that asks while another
// searches waits for it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "core/base/progress.h"
#include "core/project/document.h"

namespace limber::editor {

// What seams are found by. Equal pointers are equal contents.
struct SeamSource {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const Armature> armature;
  std::shared_ptr<const Seams> kept;        // null: they are found
  std::shared_ptr<const BoneMap> bone_map;  // null: none

  bool operator==(const SeamSource&) const = default;
};
SeamSource seam_source(const Document& document);
// What of a document's bone map fits its tissues and its rig; empty where it has none.
BoneMap usable_bone_map(const SeamSource& source);

class BodySeams {
 public:
  // Null where there is no rig, or its bones' names mean no limbs, and the document keeps none.
  std::shared_ptr<const Seams> of(const SeamSource& source, Progress& progress = no_progress());
  // The same where it needs no search; nothing where it does.
  std::optional<std::shared_ptr<const Seams>> known(const SeamSource& source);
  // Whether the rig's names mean arms, legs or fingers; asked once a rig.
  bool has_limbs(const std::shared_ptr<const Armature>& armature);

 private:
  std::mutex searching_, known_;  // the second for the members below, held for a moment only
  std::shared_ptr<const Armature> asked_;
  bool has_limbs_ = false;
  SeamSource source_;
  std::shared_ptr<const Seams> seams_;
};

// Of the program: a document is open in one editor.
BodySeams& body_seams();

}  // namespace limber::editor
