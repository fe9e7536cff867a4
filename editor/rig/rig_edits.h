// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the document's rig. While a tool changes the rig, the views show a preview rig in place of the document's
// rig. An edit keeps pose and weights: it matches old and new bones by name, and gives the weights of a removed bone to
// the nearest ancestor that remains.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/rig/edit_armature.h"

namespace limber::editor {

struct Context;

// Returns the rig that the views show: the preview rig if there is one, else the document's rig; null without a rig.
std::shared_ptr<const Armature> shown_rig(const Context& context);
void show_rig(Context& context, Armature armature);
void drop_shown_rig(Context& context);

// With X-mirror on, returns `next` with each change that was made to a bone also made, as a mirror image, to the bone's
// counterpart on the other side of the body. Changes are found by comparison with the document's rig. With X-mirror
// off, returns `next` unchanged.
Armature mirrored_too(const Context& context, Armature next);

// Commits the new rig as one edit and selects bones; does nothing when the rig is unchanged.
//   chosen  bones of the new rig to select; the last one becomes active
void commit_rig(Context& context, const std::string& label, Armature next, const std::vector<int>& chosen);
// Warns if the last edit moved the target bones of constraints (core/motion/moved_targets.h). The document has the new
// rig already.
//   before  the old rig
//   from    for each bone of the new rig, its index in the old rig; -1: a new bone
void warn_of_moved_targets(Context& context, const std::string& label, const Armature& before,
                           const std::vector<int>& from);
// Warns if the last edit moved the target bones of constraints. Finds each bone of the old rig in the new rig by its
// name.
void warn_of_moved_targets(Context& context, const std::string& label, const Armature& before);
// rename_bone() renames one bone. commit_names() commits a rig that differs from the document's rig only in the names
// of bones. Each call makes one edit. Keys, library poses, pins and locks that refer to a bone by name get the new
// name.
void rename_bone(Context& context, int bone, const std::string& name);
void commit_names(Context& context, const std::string& label, Armature next, const std::vector<int>& chosen);
// Mirrors the bones to the other side of the rig. A bone without a counterpart there gets the mirrored name and keeps
// its weights; its keys and poses are mirrored. A bone with a counterpart swaps position and name with the counterpart,
// while weights, keys and poses stay on their side of the body.
void mirror_bones(Context& context, const std::vector<int>& bones, const std::string& label);
// Returns `bones`. With X-mirror on, puts the counterparts of these bones on the other side of the body before them,
// except for counterparts that `bones` already contains.
std::vector<int> with_other_sides(const Context& context, const std::vector<int>& bones);
// Returns the document's rig with `parent` as the parent of the bones; -1: without a parent. With X-mirror on, the
// counterparts of the bones on the other side become children of the parent's counterpart, or of the parent itself if
// the parent's name has no side. If the parent has a side but no counterpart, the counterparts keep their parents.
Armature hung(const Context& context, const std::vector<int>& bones, int parent, Join join);
// Makes `parent` the parent of the bones in one edit, without moving them; -1: removes their parent.
void hang_on(Context& context, const std::vector<int>& bones, int parent);

// Deselects bones that no longer exist, for example after an undo.
void drop_missing_bones(Context& context);

}  // namespace limber::editor
