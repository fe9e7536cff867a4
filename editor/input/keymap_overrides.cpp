// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/input/keymap_overrides.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
namespace limber::editor {

std::vector<Chord> chords_of(const Keymap& keymap, const std::string& context, const std::string& operator_id) {
  std::vector<Chord> chords;
  if (const auto bindings = keymap.contexts.find(context); bindings != keymap.contexts.end())
    for (const Binding& binding : bindings->second)
      if (binding.operator_id == operator_id) chords.push_back(binding.chord);
  return chords;
}

Keymap changed(Keymap keymap, const KeyChanges& changes) {
  for (const auto& [place, keys] : changes) {
    auto& bindings = keymap.contexts[place.first];
    // Inserts the new keys where the operator's old keys were: if two operators have the same key, the first in the
    // list gets the key.
    const auto first = std::find_if(bindings.begin(), bindings.end(),
                                    [&, &id = place.second](const Binding& b) { return b.operator_id == id; });
    auto at = static_cast<std::size_t>(first - bindings.begin());
    std::erase_if(bindings, [&, &id = place.second](const Binding& b) { return b.operator_id == id; });
    for (const std::string& key : keys)
      if (const auto chord = chord_from_text(key))
        bindings.insert(bindings.begin() + static_cast<std::ptrdiff_t>(at++), Binding{*chord, place.second});
  }
  return keymap;
}

void rebind(KeyChanges& changes, const Keymap& original, const std::string& context, const std::string& operator_id,
            const std::vector<Chord>& chords) {
  if (chords_of(original, context, operator_id) == chords) {
    changes.erase({context, operator_id});
    return;
  }
  std::vector<std::string>& keys = changes[{context, operator_id}];
  keys.clear();
  for (const Chord& chord : chords) keys.push_back(to_text(chord));
}

KeyChanges differences(const Keymap& original, const Keymap& wanted) {
  KeyChanges changes;
  for (const Keymap* keymap : {&original, &wanted})
    for (const auto& [context, bindings] : keymap->contexts)
      for (const Binding& binding : bindings)
        rebind(changes, original, context, binding.operator_id, chords_of(wanted, context, binding.operator_id));
  return changes;
}

KeyChanges key_changes_from_json(const std::string& text) {
  KeyChanges changes;
  const auto json = nlohmann::json::parse(sound_json(text), nullptr, false);
  if (!json.is_array()) return changes;
  const auto text_of = [](const nlohmann::json& entry, const char* key) {
    return entry.contains(key) && entry[key].is_string() ? entry[key].get<std::string>() : std::string();
  };
  for (const auto& entry : json) {
    if (!entry.is_object()) continue;
    const std::string context = text_of(entry, "context"), id = text_of(entry, "operator");
    if (context.empty() || id.empty() || !entry.contains("keys") || !entry["keys"].is_array()) continue;
    std::vector<std::string>& list = changes[{context, id}];
    for (const auto& key : entry["keys"])
      if (key.is_string() && chord_from_text(key.get<std::string>())) list.push_back(key);
  }
  return changes;
}

std::vector<Clash> clashes(const Keymap& keymap) {
  std::vector<Clash> all;
  for (const auto& [context, bindings] : keymap.contexts)
    for (std::size_t i = 0; i < bindings.size(); ++i) {
      const Chord chord = bindings[i].chord;
      if (std::any_of(bindings.begin(), bindings.begin() + static_cast<std::ptrdiff_t>(i),
                      [&](const Binding& b) { return b.chord == chord; }))
        continue;
      Clash clash{context, chord, {}};
      for (const Binding& binding : bindings)
        if (binding.chord == chord) clash.operators.push_back(binding.operator_id);
      if (clash.operators.size() > 1) all.push_back(std::move(clash));
    }
  return all;
}

}  // namespace limber::editor
