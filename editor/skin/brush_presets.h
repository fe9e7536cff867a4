// SPDX-License-Identifier: AGPL-3.0-or-later
// Named sets of brush settings that the user saves, uses and deletes. They apply to all projects and are stored in
// brushes.json beside the preferences.
#pragma once

#include <string>
#include <vector>

#include "core/paint/stroke.h"

namespace limber::editor {

struct Context;

struct BrushPreset {
  std::string name;  // name of the preset, different from that of every other preset
  BrushKind kind = {};
  double radius = 20, strength = 0.75, value = 1;  // radius in mm; strength and value in [0, 1]
  double blend = 40;  // Painting::blend_mm of the joint capsule brush, mm; always 40 for other brushes
  FalloffShape falloff = {};
  std::vector<glm::dvec2> falloff_curve;  // points of a custom falloff curve, as in Painting; empty: `falloff` is used

  bool operator==(const BrushPreset&) const = default;
};

struct BrushPresets {
  std::vector<BrushPreset> list;  // the presets in the order in which they were saved
};

constexpr std::size_t kMostBrushPresets = 200;

std::string brush_presets_json(const std::vector<BrushPreset>& presets);
// Reads presets. Numbers are clamped to their range, and presets that cannot be read are left out. Throws Error with
// `where` (the file) if the text holds no presets.
std::vector<BrushPreset> brush_presets_from_json(const std::string& text, const std::string& where);

// Returns the user's presets. Reads the file at the first call; warns if it is damaged.
const std::vector<BrushPreset>& brush_presets(Context& context);
// Returns false if the user is known to have no preset. Does not read the file.
bool has_brush_presets(const Context& context);
// Returns the index of the preset whose settings all equal the brush's settings; -1 if there is no such preset.
int brush_preset_in_use(Context& context);

// save_brush_preset() saves the brush's settings under a name and replaces a preset of the same name.
// delete_brush_preset() deletes a preset. Both write the file; presets that other programs have saved meanwhile, and
// entries that cannot be read, stay in it. Both throw Error if the file cannot be written or is not a presets file;
// the presets then do not change. require_preset_name() throws Error if the name is blank or too long, or if there are
// too many presets.
void require_preset_name(const std::vector<BrushPreset>& presets, const std::string& name);
void save_brush_preset(Context& context, const std::string& name);
void delete_brush_preset(Context& context, const std::string& name);
// Gives the weight brush the settings of a preset, and selects it instead of the label brush or the seam brush.
void use_brush_preset(Context& context, const std::string& name);

}  // namespace limber::editor
