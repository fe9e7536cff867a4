// SPDX-License-Identifier: AGPL-3.0-or-later
// The rig that is worked on: the document's, or what is shown in its place while a tool changes it. An edit takes pose
// and weights along: bones are known again by their names, the weight of a removed bone goes to the one above it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/rig/edit_armature.h"
#include "editor/context/editor.h"

namespace limber::editor {

// Null for none.
std::shared_ptr<const Armature> shown_rig(const Editor& editor);
void show_rig(Editor& editor, Armature armature);
void drop_shown_rig(Editor& editor);

// With X-mirror on, the other sides of the bones that differ from the document's change likewise.
Armature mirrored_too(const Editor& editor, Armature next);

// One edit; none where nothing changed.
//   chosen  bones of the new rig, the last of them active
void commit_rig(Editor& editor, const std::string& label, Armature next, const std::vector<int>& chosen);
// The same for bones that only change their names; all that goes by names follows.
void rename_bone(Editor& editor, int bone, const std::string& name);
void commit_names(Editor& editor, const std::string& label, Armature next, const std::vector<int>& chosen);
// To the other side of the rig. A bone that takes the free name of that side takes its weights, and mirrored its keys
// and poses along; the two of a pair change places, and what belongs to each side stays there.
void mirror_bones(Editor& editor, const std::vector<int>& bones, const std::string& label);
// With X-mirror on, the bones on the other side too, before the others.
std::vector<int> with_other_sides(const Editor& editor, const std::vector<int>& bones);
// The rig with bones that hang on another one, on nothing where that is -1. With X-mirror on, those of the other side
// hang on the other side of it likewise, where it has one.
Armature hung(const Editor& editor, const std::vector<int>& bones, int parent, Join join);
// The same as an edit, where the bones are.
void hang_on(Editor& editor, const std::vector<int>& bones, int parent);

// Bones that are still there: after an undo the choice may speak of others.
void drop_missing_bones(Editor& editor);

}  // namespace limber::editor
