// SPDX-License-Identifier: AGPL-3.0-or-later
// What a user changed in the key map: for an operator in a context, the keys it has instead of its own. Two operators
// may then want one key; the first of the context has it, and clashes() tells.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "editor/input/keymap.h"

namespace limber::editor {

using KeyChanges =
    std::map<std::pair<std::string, std::string>, std::vector<std::string>>;  // context, operator -> keys

// The key map with the changes made. Keys that cannot be read are left out.
Keymap changed(Keymap keymap, const KeyChanges& changes);
// Gives `chord` to the operator in place of the keys it has there; the same as its own keys: no change any more.
void rebind(KeyChanges& changes, const Keymap& original, const std::string& context, const std::string& operator_id,
            const std::vector<Chord>& chords);

// What must be changed in `original` so that it does what `wanted` does.
KeyChanges differences(const Keymap& original, const Keymap& wanted);

// A list of objects with context, operator and keys; what cannot be read of it is left out.
KeyChanges key_changes_from_json(const std::string& text);

struct Clash {
  std::string context;
  Chord chord;
  std::vector<std::string> operators;  // the first one has the key
};
std::vector<Clash> clashes(const Keymap& keymap);

std::vector<Chord> chords_of(const Keymap& keymap, const std::string& context, const std::string& operator_id);

}  // namespace limber::editor
