// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/input/keymap.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"

namespace limber::editor {

namespace {

// Largest size of a key map file, bytes; the presets have 13 kB. The size is limited because finding clashes takes
// quadratic time.
constexpr std::uint64_t kLargestFile = 1 << 20;

Binding binding_of(const nlohmann::json& json, const std::string& context, const Path& path) {
  const std::string place = path.string() + ", context " + context;
  if (!json.is_object() || !json.contains("key") || !json["key"].is_string() || !json.contains("operator") ||
      !json["operator"].is_string())
    throw Error("a binding needs \"key\" and \"operator\"", place, "add the missing part");
  const std::string key = json["key"];
  const auto chord = chord_from_text(key);
  if (!chord)
    throw Error("the key '" + key + "' is unknown", place, "write it like Ctrl+Shift+Z, Num1, MMB or Alt+LMBdrag");
  return {*chord, json["operator"]};
}

const Chord* find_in(const std::vector<Binding>& bindings, std::string_view operator_id) {
  const auto found = std::find_if(bindings.begin(), bindings.end(),
                                  [&](const Binding& binding) { return binding.operator_id == operator_id; });
  return found == bindings.end() ? nullptr : &found->chord;
}

}  // namespace

const std::string* Keymap::find(const Chord& chord, const std::vector<std::string>& in) const {
  for (const std::string& context : in) {
    const auto bindings = contexts.find(context);
    if (bindings == contexts.end()) continue;
    for (const Binding& binding : bindings->second)
      if (binding.chord == chord) return &binding.operator_id;
  }
  return nullptr;
}

std::optional<Chord> Keymap::chord_of(std::string_view operator_id, const std::vector<std::string>& first) const {
  for (const std::string& context : first)
    if (const auto bindings = contexts.find(context); bindings != contexts.end())
      if (const Chord* chord = find_in(bindings->second, operator_id)) return *chord;
  for (const auto& [context, bindings] : contexts)
    if (const Chord* chord = find_in(bindings, operator_id)) return *chord;
  return std::nullopt;
}

Keymap read_keymap(const Path& path, TwoMeanings two_meanings) {
  const auto json = nlohmann::json::parse(checked_json(read_file(path, kLargestFile), path.string()), nullptr, false);
  if (!json.is_object() || json.value("schema", nlohmann::json()) != "limber-keymap/1" || !json.contains("contexts") ||
      !json["contexts"].is_object())
    throw Error("this is not a keymap", path.string(), "select another file");
  Keymap keymap;
  for (const auto& [context, bindings] : json["contexts"].items()) {
    if (!bindings.is_array())
      throw Error("a context must be a list of bindings", path.string() + ", context " + context,
                  "write a list of bindings");
    auto& list = keymap.contexts[context];
    for (const auto& entry : bindings) {
      const Binding binding = binding_of(entry, context, path);
      if (two_meanings == TwoMeanings::Refuse && keymap.find(binding.chord, {context}))
        throw Error("the key " + to_text(binding.chord) + " runs two commands", path.string() + ", context " + context,
                    "remove one of the two bindings");
      list.push_back(binding);
    }
  }
  return keymap;
}

std::string to_json(const Keymap& keymap) {
  nlohmann::ordered_json json{{"schema", "limber-keymap/1"}, {"contexts", nlohmann::ordered_json::object()}};
  for (const auto& [context, bindings] : keymap.contexts) {
    auto& list = json["contexts"][context] = nlohmann::ordered_json::array();
    for (const Binding& binding : bindings)
      list.push_back({{"key", to_text(binding.chord)}, {"operator", binding.operator_id}});
  }
  return json.dump(1) + "\n";
}

}  // namespace limber::editor
