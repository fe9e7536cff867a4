// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/brush_presets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "editor/context/context.h"
#include "editor/context/preferences_state.h"
#include "editor/labels/label_brush.h"
#include "editor/seams/seam_view.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "limber-brushes/1";
// Names of the falloff shapes in the presets file, in the order of FalloffShape.
constexpr std::array kFalloffs = {"smooth", "sphere", "root", "sharp", "linear", "constant"};
// A falloff curve with more points is ignored; the Brush panel has the same limit.
constexpr std::size_t kMostPoints = 16;
constexpr std::size_t kLongestName = 100;

Path presets_path(const PreferencesState& preferences_state) {
  return preferences_state.path.empty() ? Path() : preferences_state.path.parent_path() / "brushes.json";
}

Json json_of(const BrushPreset& preset) {
  Json json{{"name", preset.name},        {"brush", brush_rules()[static_cast<std::size_t>(preset.kind)].id},
            {"radius_mm", preset.radius}, {"strength", preset.strength},
            {"value", preset.value},      {"falloff", kFalloffs[static_cast<std::size_t>(preset.falloff)]}};
  if (preset.kind == BrushKind::JointCapsule) json["blend_mm"] = preset.blend;
  for (const glm::dvec2& point : preset.falloff_curve) json["curve"].push_back({point.x, point.y});
  return json;
}

double number_in(const Json& json, const char* key, double low, double high, double otherwise) {
  const Json number = json.value(key, Json());
  return number.is_number() ? std::clamp(number.get<double>(), low, high) : otherwise;
}

// Returns the points of a custom falloff curve. Returns no points unless there are 2 to 16 points in [0, 1] with
// increasing x.
std::vector<glm::dvec2> curve_of(const Json& json) {
  std::vector<glm::dvec2> curve;
  const Json points = json.value("curve", Json());
  if (!points.is_array() || points.size() < 2 || points.size() > kMostPoints) return {};
  for (const Json& point : points) {
    if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number()) return {};
    const glm::dvec2 at(point[0].get<double>(), point[1].get<double>());
    const double least = curve.empty() ? 0 : std::nextafter(curve.back().x, 2);
    if (!(at.x >= least && at.x <= 1 && at.y >= 0 && at.y <= 1)) return {};
    curve.push_back(at);
  }
  return curve;
}

std::optional<BrushPreset> preset_of(const Json& json) {
  if (!json.is_object() || !json.value("name", Json()).is_string() || !json.value("brush", Json()).is_string())
    return std::nullopt;
  BrushPreset preset;
  preset.name = json["name"].get<std::string>();
  const std::string id = json["brush"].get<std::string>();
  const auto& rules = brush_rules();
  const auto rule = std::find_if(rules.begin(), rules.end(), [&](const BrushRule& one) { return one.id == id; });
  if (preset.name.empty() || preset.name.size() > kLongestName || rule == rules.end()) return std::nullopt;
  preset.kind = rule->kind;
  preset.radius = number_in(json, "radius_mm", Painting::kLeastRadius, Painting::kMostRadius, preset.radius);
  preset.strength = number_in(json, "strength", 0, 1, preset.strength);
  preset.value = number_in(json, "value", 0, 1, preset.value);
  if (preset.kind == BrushKind::JointCapsule) preset.blend = number_in(json, "blend_mm", 1, 300, preset.blend);
  const Json falloff = json.value("falloff", Json());
  for (std::size_t i = 0; i < kFalloffs.size(); ++i)
    if (falloff == kFalloffs[i]) preset.falloff = static_cast<FalloffShape>(i);
  preset.falloff_curve = curve_of(json);
  return preset;
}

auto named(std::vector<BrushPreset>& presets, const std::string& name) {
  return std::find_if(presets.begin(), presets.end(), [&](const BrushPreset& one) { return one.name == name; });
}

BrushPreset preset_of_brush(const Painting& painting, const std::string& name) {
  BrushPreset preset{.name = name,
                     .kind = painting.kind,
                     .radius = painting.radius,
                     .strength = painting.strength,
                     .value = painting.value,
                     .falloff = painting.falloff,
                     .falloff_curve = painting.falloff_curve};
  if (preset.kind == BrushKind::JointCapsule) preset.blend = painting.blend_mm;
  return preset;
}

Json file_of(const std::vector<BrushPreset>& presets) {
  Json json{{"schema", kSchema}, {"presets", Json::array()}};
  for (const BrushPreset& preset : presets) json["presets"].push_back(json_of(preset));
  return json;
}

// Parses the text of a presets file. Throws Error if the text holds no presets.
Json file_from(const std::string& text, const std::string& where) {
  Json json = Json::parse(checked_json(text, where), nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != kSchema || !json.value("presets", Json()).is_array())
    throw Error("this file holds no brush presets", where, "move it to another folder, then save the presets again");
  return json;
}

std::vector<BrushPreset> presets_in(const Json& file) {
  std::vector<BrushPreset> presets;
  for (const Json& one : file["presets"])
    if (auto preset = preset_of(one);
        preset && named(presets, preset->name) == presets.end() && presets.size() < kMostBrushPresets)
      presets.push_back(std::move(*preset));
  return presets;
}

std::string text_of_file(const Json& file) { return file.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

// Reads the presets file again, lets `change` change its list of presets, and writes the file. Reading it again keeps
// the presets that another running Limber has saved meanwhile, and entries that this version cannot read.
void change_file(Context& context, const std::function<void(Json& presets)>& change) {
  const Path path = presets_path(context.preferences_state);
  Json file = file_of(path.empty() ? brush_presets(context) : std::vector<BrushPreset>{});
  if (!path.empty() && std::filesystem::exists(path)) file = file_from(read_file(path), path.string());
  change(file["presets"]);
  if (!path.empty()) {
    std::filesystem::create_directories(path.parent_path());
    write_file_atomically(path, text_of_file(file));
  }
  context.skin->painting->presets = std::make_shared<BrushPresets>(BrushPresets{presets_in(file)});
  context.ui->touch();
}

bool is_preset_named(const Json& entry, const std::string& name) {
  const auto preset = preset_of(entry);
  return preset && preset->name == name;
}

}  // namespace

std::string brush_presets_json(const std::vector<BrushPreset>& presets) { return text_of_file(file_of(presets)); }

std::vector<BrushPreset> brush_presets_from_json(const std::string& text, const std::string& where) {
  return presets_in(file_from(text, where));
}

bool has_brush_presets(const Context& context) {
  if (const auto& presets = context.skin->painting->presets) return !presets->list.empty();
  std::error_code unknown;
  const Path path = presets_path(context.preferences_state);
  return !path.empty() && std::filesystem::exists(path, unknown);
}

const std::vector<BrushPreset>& brush_presets(Context& context) {
  auto& presets = context.skin->painting->presets;
  if (presets) return presets->list;
  presets = std::make_shared<BrushPresets>();
  const Path path = presets_path(context.preferences_state);
  std::error_code unknown;
  if (path.empty() || !std::filesystem::exists(path, unknown)) return presets->list;
  try {
    presets->list = brush_presets_from_json(read_file(path), path.string());
  } catch (const Error& error) {
    context.messages->warn("The brush presets could not be read", error.what());
  }
  return presets->list;
}

int brush_preset_in_use(Context& context) {
  const auto& presets = brush_presets(context);
  for (std::size_t i = 0; i < presets.size(); ++i)
    if (preset_of_brush(*context.skin->painting, presets[i].name) == presets[i]) return static_cast<int>(i);
  return -1;
}

void require_preset_name(const std::vector<BrushPreset>& presets, const std::string& name) {
  const char* const kHint = "type a name of up to 100 letters";
  if (name.find_first_not_of(" \t") == std::string::npos) throw Error("a brush preset needs a name", "name", kHint);
  if (name.size() > kLongestName) throw Error("this name is too long", std::to_string(name.size()) + " bytes", kHint);
  const bool is_new = std::none_of(presets.begin(), presets.end(), [&](const auto& one) { return one.name == name; });
  if (is_new && presets.size() >= kMostBrushPresets)
    throw Error("there are too many brush presets", std::to_string(presets.size()), "delete a preset first");
}

void save_brush_preset(Context& context, const std::string& name) {
  const Json saved = json_of(preset_of_brush(*context.skin->painting, name));
  change_file(context, [&](Json& presets) {
    require_preset_name(presets_in(Json{{"presets", presets}}), name);
    for (Json& entry : presets)
      if (is_preset_named(entry, name)) return void(entry = saved);
    presets.push_back(saved);
  });
}

void delete_brush_preset(Context& context, const std::string& name) {
  change_file(context, [&](Json& presets) {
    Json kept = Json::array();
    for (const Json& entry : presets)
      if (!is_preset_named(entry, name)) kept.push_back(entry);
    presets = std::move(kept);
  });
}

void use_brush_preset(Context& context, const std::string& name) {
  Painting& painting = *context.skin->painting;
  for (const BrushPreset& preset : brush_presets(context)) {
    if (preset.name != name) continue;
    painting.kind = preset.kind;
    painting.radius = preset.radius;
    painting.strength = preset.strength;
    painting.value = preset.value;
    painting.falloff = preset.falloff;
    painting.falloff_curve = preset.falloff_curve;
    if (preset.kind == BrushKind::JointCapsule) painting.blend_mm = preset.blend;
    context.seams->brush = painting.labels->on = false;
    return context.ui->touch();
  }
  throw Error("there is no such brush preset any more", name, "select another preset");
}

}  // namespace limber::editor
