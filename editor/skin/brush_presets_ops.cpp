// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of brush presets: save the brush's settings under a name, use those of a preset, delete one.
#include <algorithm>

#include "core/base/error.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/skin/brush_presets.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

using Fields = std::vector<FormField>;

std::string needs_preset(const Context& context) {
  return has_brush_presets(context) ? "" : "Save a brush preset first";
}

void ask_name(Context& context) {
  const int in_use = brush_preset_in_use(context);
  const std::string name = in_use < 0 ? "" : brush_presets(context)[static_cast<std::size_t>(in_use)].name;
  std::vector<std::string> names;
  for (const BrushPreset& preset : brush_presets(context)) names.push_back(preset.name);
  const auto outcome = [names, presets = brush_presets(context)](const Context& c,
                                                                 const Fields& fields) -> std::string {
    if (fields[0].text.empty()) throw NotYet{"Type a name."};
    require_preset_name(presets, fields[0].text);
    if (std::find(names.begin(), names.end(), fields[0].text) != names.end())
      return "Replaces the preset \"" + fields[0].text + "\".";
    return "Saves " + name_of(c.skin->painting->kind) + " with its radius, strength, value and falloff.";
  };
  const auto act = [](Context& c, const Fields& fields) { save_brush_preset(c, fields[0].text); };
  context.dialogs->open(make_form({"Save brush preset",
                                   "Saves the settings of the weight brush under a name, for use in all projects.",
                                   "Save",
                                   {text_of("Name", "The name of the preset.", name)},
                                   outcome,
                                   act}));
}

// Opens a form in which the user selects a preset.
void ask_preset(Context& context, const char* title, const char* description, const char* action,
                void (*act)(Context&, const std::string&)) {
  std::vector<std::string> names;
  for (const BrushPreset& preset : brush_presets(context)) names.push_back(preset.name);
  if (names.empty())
    throw Error("there are no brush presets yet", title, "save a preset first: Edit > Brush > Presets");
  context.dialogs->open(
      make_form({title,
                 description,
                 action,
                 {choice_of("Preset", "The brush preset.", names, std::max(0, brush_preset_in_use(context)))},
                 nullptr,
                 [act](Context& c, const Fields& fields) {
                   act(c, fields[0].choices[static_cast<std::size_t>(fields[0].chosen)]);
                 }}));
}

}  // namespace

std::vector<Operator> brush_preset_operators() {
  return {
      {"skin.preset_save", "Save brush preset...", icon::kAdd, "Brush",
       "Save the brush's kind, radius, strength, value and falloff under a name.", ask_name},
      {"skin.preset_use", "Use brush preset...", icon::kSkin, "Brush", "Give the brush the settings of a saved preset.",
       [](Context& c) {
         ask_preset(c, "Use brush preset", "Gives the weight brush the settings of a preset.", "Use", use_brush_preset);
       },
       needs_preset},
      {"skin.preset_delete", "Delete brush preset...", icon::kClose, "Brush", "Delete a saved brush preset.",
       [](Context& c) {
         ask_preset(c, "Delete brush preset", "Deletes a preset. The brush keeps its settings.", "Delete",
                    delete_brush_preset);
       },
       needs_preset},
  };
}

}  // namespace limber::editor
