// SPDX-License-Identifier: AGPL-3.0-or-later
// The user's changes of the key map. A change replaces the original keys of an operator in a context by other keys.
// After a change, two operators of a context may have the same key. The first of them gets the key, and clashes()
// reports both operators.
#pragma once

#include <string>
#include <vector>

#include "editor/input/key_changes.h"
#include "editor/input/keymap.h"

namespace limber::editor {

// Returns the key map after the changes. Keys that cannot be read are left out.
Keymap changed(Keymap keymap, const KeyChanges& changes);
// Records in `changes` that the operator has these chords in the context. If the operator has these chords in the
// original key map, its entry in `changes` is removed instead.
void rebind(KeyChanges& changes, const Keymap& original, const std::string& context, const std::string& operator_id,
            const std::vector<Chord>& chords);

// Returns the changes that turn the key map `original` into `wanted`.
KeyChanges differences(const Keymap& original, const Keymap& wanted);

// Reads the changes from a JSON list of objects with context, operator and keys. Entries that cannot be read are left
// out.
KeyChanges key_changes_from_json(const std::string& text);

struct Clash {
  std::string context;
  Chord chord;
  std::vector<std::string> operators;  // at least two; the first one gets the key
};
std::vector<Clash> clashes(const Keymap& keymap);

std::vector<Chord> chords_of(const Keymap& keymap, const std::string& context, const std::string& operator_id);

}  // namespace limber::editor
