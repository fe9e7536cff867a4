// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/layout_json.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
namespace limber::editor {

namespace {

using Json = nlohmann::json;

template <class Switch>
void take_switch(const Json& json, const char* key, Switch& value) {
  if (const auto found = json.find(key); found != json.end() && found->is_boolean())
    value = found->template get<bool>();
}

void take_size(const Json& json, const char* key, float low, float high, float& value) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return;
  if (const double size = *found; size >= low && size <= high) value = static_cast<float>(size);
}

// Reads an enumerator that is stored as its number. Returns no value if the number is missing or not in [0, count).
template <class Choice>
std::optional<Choice> choice(const Json& json, const char* key, int count) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_integer()) return std::nullopt;
  const auto number = found->template get<std::int64_t>();
  return number >= 0 && number < count ? std::optional(static_cast<Choice>(number)) : std::nullopt;
}

Json json_of(const Arrangement& arrangement) {
  Json json{{"views", static_cast<int>(arrangement.views)},
            {"tool_strip", arrangement.tool_strip},
            {"console", arrangement.console},
            {"results", arrangement.results},
            {"timeline", arrangement.timeline},
            {"sidebar_width", arrangement.sidebar_width},
            {"bottom_height", arrangement.bottom_height},
            {"split_x", arrangement.split_x},
            {"split_y", arrangement.split_y},
            {"four_x", arrangement.four_x},
            {"four_y", arrangement.four_y}};
  if (arrangement.sidebar) json["sidebar"] = *arrangement.sidebar;
  if (arrangement.maximized) json["maximized"] = static_cast<int>(*arrangement.maximized);
  return json;
}

void restore(const Json& json, Arrangement& arrangement) {
  if (!json.is_object()) return;
  arrangement.views = choice<ViewLayout>(json, "views", 3).value_or(arrangement.views);
  take_switch(json, "tool_strip", arrangement.tool_strip);
  take_switch(json, "console", arrangement.console);
  take_switch(json, "results", arrangement.results);
  take_switch(json, "timeline", arrangement.timeline);
  take_switch(json, "sidebar", arrangement.sidebar);
  take_size(json, "sidebar_width", 260, 520, arrangement.sidebar_width);
  take_size(json, "bottom_height", 60, 4000, arrangement.bottom_height);
  for (const auto& [key, share] : {std::pair{"split_x", &arrangement.split_x},
                                   {"split_y", &arrangement.split_y},
                                   {"four_x", &arrangement.four_x},
                                   {"four_y", &arrangement.four_y}})
    take_size(json, key, 0.2f, 0.8f, *share);
  arrangement.maximized = choice<ViewId>(json, "maximized", 4);
}

}  // namespace

std::string json_text(const Arrangements& arrangements) {
  Json json = Json::array();
  for (const Arrangement& arrangement : arrangements) json.push_back(json_of(arrangement));
  return json.dump();
}

void restore(const std::string& text, Arrangements& arrangements) {
  const Json json = Json::parse(sound_json(text), nullptr, false);
  if (!json.is_array()) return;
  for (std::size_t i = 0; i < std::min(json.size(), arrangements.size()); ++i) restore(json[i], arrangements[i]);
}

}  // namespace limber::editor
