// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the document's rig, and the preview rig that the views show instead while a tool changes the rig. An edit
// keeps pose and weights: it matches old and new bones by name, and gives the weights of a removed bone to the nearest
// ancestor that remains.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/rig/edit_armature.h"
#include "editor/context/editor.h"

namespace limber::editor {

// Returns the rig that the views show: the preview rig if there is one, else the document's rig; null without a rig.
std::shared_ptr<const Armature> shown_rig(const Editor& editor);
void show_rig(Editor& editor, Armature armature);
void drop_shown_rig(Editor& editor);

// With X-mirror on, returns `next` with every difference from the document's rig also applied, mirrored, to the bone of
// the other side of the body. With X-mirror off, returns `next` unchanged.
Armature mirrored_too(const Editor& editor, Armature next);

// Commits the new rig as one edit and selects bones; does nothing when the rig is unchanged.
//   chosen  bones of the new rig to select; the last one becomes active
void commit_rig(Editor& editor, const std::string& label, Armature next, const std::vector<int>& chosen);
// The first renames one bone, the second commits a rig in which only bone names differ; each makes one edit. Everything
// that refers to a bone by name (keys, library poses, pins, locks) then refers to the new name.
void rename_bone(Editor& editor, int bone, const std::string& name);
void commit_names(Editor& editor, const std::string& label, Armature next, const std::vector<int>& chosen);
// Mirrors the bones to the other side of the rig. If no bone has the mirrored name, the bone takes that name and keeps
// its weights, and its keys and poses are mirrored. Two bones of a left-right pair exchange positions and names, while
// weights, keys and poses stay on their side of the body.
void mirror_bones(Editor& editor, const std::vector<int>& bones, const std::string& label);
// With X-mirror on, returns the counterparts of the bones on the other side that are not in `bones`, followed by
// `bones`. With X-mirror off, returns `bones`.
std::vector<int> with_other_sides(const Editor& editor, const std::vector<int>& bones);
// Returns the document's rig with `parent` as the parent of the bones; -1: without a parent. With X-mirror on, the
// counterparts of the bones on the other side become children of the parent's counterpart, or of the parent itself if
// its name has no side. They stay unchanged if the parent has a side but no counterpart.
Armature hung(const Editor& editor, const std::vector<int>& bones, int parent, Join join);
// Makes `parent` the parent of the bones in one edit, without moving them; -1: removes their parent.
void hang_on(Editor& editor, const std::vector<int>& bones, int parent);

// Removes bones from the selection that no longer exist, as after an undo.
void drop_missing_bones(Editor& editor);

}  // namespace limber::editor
