// SPDX-License-Identifier: AGPL-3.0-or-later
// Named sets of brush settings that the user saves, uses and deletes. They belong to the user, not to a project, and
// are kept in brushes.json beside the preferences.
#pragma once

#include <string>
#include <vector>

#include "core/paint/stroke.h"
#include "editor/context/editor.h"
#include "editor/skin/painting.h"

namespace limber::editor {

struct BrushPreset {
  std::string name;  // unique among the presets
  BrushKind kind = {};
  double radius = 20, strength = 0.75, value = 1;  // mm; [0, 1]; [0, 1]
  double blend = 40;  // Painting::blend_mm of the joint capsule brush, mm; of others always 40
  FalloffShape falloff = {};
  std::vector<glm::dvec2> falloff_curve;  // as Painting::falloff_curve

  bool operator==(const BrushPreset&) const = default;
};

struct BrushPresets {
  std::vector<BrushPreset> list;  // in the order in which they were saved
};

constexpr std::size_t kMostBrushPresets = 200;

std::string brush_presets_json(const std::vector<BrushPreset>& presets);
// Reads presets. Numbers are clamped to their range, and presets that cannot be read are left out. Throws Error with
// `where` (the file) if the text holds no presets.
std::vector<BrushPreset> brush_presets_from_json(const std::string& text, const std::string& where);

// Returns the user's presets. Reads the file at the first call; warns if it is damaged.
const std::vector<BrushPreset>& brush_presets(Editor& editor);
// Returns false where there is no preset, as far as that is known without reading the file.
bool has_brush_presets(const Editor& editor);
// Returns the index of the preset that the brush has all settings of; -1: none.
int brush_preset_in_use(Editor& editor);

// Saves the brush's settings under a name, in place of the preset that has the name already, and writes the file.
// Throws Error if it cannot be written, or if the file holds no presets and so is not Limber's to replace; the presets
// then stay as they were. What other programs have saved meanwhile, and entries that are not understood, are kept.
// Throws Error if no preset can be saved under a name: it is blank or too long, or there are too many presets.
void require_preset_name(const std::vector<BrushPreset>& presets, const std::string& name);
void save_brush_preset(Editor& editor, const std::string& name);
void delete_brush_preset(Editor& editor, const std::string& name);
// Gives the weight brush the settings of a preset, and lets it paint instead of the label or seam brush.
void use_brush_preset(Editor& editor, const std::string& name);

}  // namespace limber::editor
