// SPDX-License-Identifier: AGPL-3.0-or-later
// The key map: which operator a chord (key or button with modifiers) runs in each context. Contexts are global, view3d,
// slice, select, and one for each workspace. The contexts that apply are searched in order, and the first that binds
// the chord wins. A key can therefore have another meaning in one view or workspace. The presets are
// assets/keymap*.json.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/file.h"
#include "editor/input/keys.h"

namespace limber::editor {

struct Binding {
  Chord chord;
  std::string operator_id;
};

struct Keymap {
  std::map<std::string, std::vector<Binding>> contexts;

  // Returns the id of the operator that a chord runs: the one in the first context of `in` that binds the chord.
  // Returns nullptr if no context binds the chord.
  const std::string* find(const Chord& chord, const std::vector<std::string>& in) const;
  // Returns the chord to show beside an operator's name: the first chord that is bound to the operator. The contexts
  // `first` are searched before all others.
  std::optional<Chord> chord_of(std::string_view operator_id, const std::vector<std::string>& first = {}) const;
};

// Says whether a key map file may bind one chord to two operators in the same context. With Refuse, read_keymap()
// throws Error for such a chord. In either case it throws Error for a file that is no key map and for an unreadable
// chord.
enum class TwoMeanings { Refuse, LetIn };
Keymap read_keymap(const Path& path, TwoMeanings two_meanings = TwoMeanings::Refuse);
std::string to_json(const Keymap& keymap);

}  // namespace limber::editor
