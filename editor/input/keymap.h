// SPDX-License-Identifier: AGPL-3.0-or-later
// Which chord starts which operator, by context (global, view3d, slice, select, and one for each workspace); read from
// assets/keymap.json. The first context in which a chord has a meaning wins, so a key may mean one thing in a place.
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

  // The operator of a chord in the first of these contexts that knows it; nullptr for none.
  const std::string* find(const Chord& chord, const std::vector<std::string>& in) const;
  // The chord to show beside an operator's name: its first, looking into `first` before the other contexts.
  std::optional<Chord> chord_of(std::string_view operator_id, const std::vector<std::string>& first = {}) const;
};

// Throws Error for a file that is no key map, an unreadable chord, or, unless they are let in, a chord with two
// meanings in one context.
enum class TwoMeanings { Refuse, LetIn };
Keymap read_keymap(const Path& path, TwoMeanings two_meanings = TwoMeanings::Refuse);
std::string to_json(const Keymap& keymap);

}  // namespace limber::editor
