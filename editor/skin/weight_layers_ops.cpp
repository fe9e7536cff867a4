// SPDX-License-Identifier: AGPL-3.0-or-later
// Layers of weights: added, ordered, masked, merged down, removed.
#include <algorithm>

#include "editor/context/operator.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
  return seen_weights(editor) ? "" : "Compute the weights first";
}

std::string needs_layer(const Editor& editor) {
  if (std::string why = needs_weights(editor); !why.empty()) return why;
  return active_layer(editor) ? "" : "Choose a layer above the base first";
}

WeightLayers layers_of(const Editor& editor) {
  const Document& document = editor.document();
  return document.layers ? *document.layers : WeightLayers{document.weights, {}};
}

const std::string& name_of_active(const Editor& editor) {
  return editor.document().layers->layers[*active_layer(editor)]->name;
}

void add(Editor& editor) {
  WeightLayers next = layers_of(editor);
  std::string name;
  for (int number = 1; name.empty() || std::any_of(next.layers.begin(), next.layers.end(),
                                                   [&](const auto& layer) { return layer->name == name; });
       ++number)
    name = "Layer " + std::to_string(number);
  next = with_new_layer(next, name);
  // Above the active one, or at the top.
  const std::size_t at = active_layer(editor) ? *active_layer(editor) + 1 : next.layers.size() - 1;
  std::rotate(next.layers.begin() + static_cast<std::ptrdiff_t>(at), next.layers.end() - 1, next.layers.end());
  commit_layers(editor, "Add " + name, std::move(next));
  choose_layer(editor, at);
}

void remove(Editor& editor) {
  const std::size_t layer = *active_layer(editor);
  WeightLayers next = layers_of(editor);
  next.layers.erase(next.layers.begin() + static_cast<std::ptrdiff_t>(layer));
  commit_layers(editor, "Remove " + name_of_active(editor), std::move(next));
  choose_layer(editor, layer > 0 ? std::optional(layer - 1) : std::nullopt);
}

void move(Editor& editor, int by) {
  const std::size_t layer = *active_layer(editor), to = layer + static_cast<std::size_t>(by);
  WeightLayers next = layers_of(editor);
  std::swap(next.layers[layer], next.layers[to]);
  commit_layers(editor, (by > 0 ? "Raise " : "Lower ") + name_of_active(editor), std::move(next));
  choose_layer(editor, to);
}

void merge_down(Editor& editor) {
  const std::size_t layer = *active_layer(editor);
  const std::string label = "Merge " + name_of_active(editor) + " down";
  commit_layers(editor, label, merged_down(layers_of(editor), layer));
  choose_layer(editor, layer > 0 ? std::optional(layer - 1) : std::nullopt);
}

void cover(Editor& editor, double share, const char* label) {
  const std::size_t layer = *active_layer(editor);
  WeightLayers next = layers_of(editor);
  next.layers[layer] = std::make_shared<const WeightLayer>(
      with_mask(next, layer, *tissue_voxels(*editor.views, editor.document()), {}, share));
  commit_layers(editor, label + name_of_active(editor), std::move(next));
}

}  // namespace

std::vector<Operator> layer_operators() {
  return {
      {"skin.layer_add", "New layer", icon::kAdd, "Layers",
       "Puts an empty layer of weights above the active one: what is painted on it changes nothing below.", add,
       needs_weights},
      {"skin.layer_remove", "Remove layer", icon::kTrash, "Layers",
       "Takes the active layer away, with what was painted on it.", remove, needs_layer},
      {"skin.layer_rename", "Rename layer", icon::kRename, "Layers", "Gives the active layer another name.",
       [](Editor& e) {
         e.arrangement().sidebar = e.open_sections["Layers"] = true;
         e.wanted_section = "Layers";
         begin_renaming(e, "layers" + std::to_string(*active_layer(e)), name_of_active(e));
       },
       needs_layer},
      {"skin.layer_show", "Show layer", icon::kVisible, "Layers", "Shows or hides what the active layer changes.",
       [](Editor& e) { show_layer(e, *active_layer(e), !e.document().layers->layers[*active_layer(e)]->visible); },
       needs_layer,
       [](const Editor& e) { return active_layer(e) && e.document().layers->layers[*active_layer(e)]->visible; }},
      {"skin.layer_up", "Raise layer", icon::kUp, "Layers", "Puts the active layer above the next one.",
       [](Editor& e) { move(e, 1); },
       [](const Editor& e) {
         const std::string why = needs_layer(e);
         return !why.empty()                                                 ? why
                : *active_layer(e) + 1 == e.document().layers->layers.size() ? "It is the uppermost layer"
                                                                             : "";
       }},
      {"skin.layer_down", "Lower layer", icon::kDown, "Layers", "Puts the active layer below the next one.",
       [](Editor& e) { move(e, -1); },
       [](const Editor& e) {
         const std::string why = needs_layer(e);
         return !why.empty() ? why : *active_layer(e) == 0 ? "It is the lowest layer" : "";
       }},
      {"skin.layer_merge", "Merge down", icon::kMergeDown, "Layers",
       "Joins the active layer with the one below it, or with the base; what is seen stays.", merge_down, needs_layer},
      {"skin.layer_mask", "Paint mask", icon::kMask, "Layers",
       "Strokes change where the active layer covers, in place of weights: add lets it cover, subtract lets through "
       "what is below.",
       [](Editor& e) { e.skin->painting->mask = !e.skin->painting->mask; }, needs_layer,
       [](const Editor& e) { return e.skin->painting->mask && active_layer(e).has_value(); }},
      {"skin.layer_cover", "Cover everywhere", "", "Layers",
       "The active layer covers the whole body with what is seen there.",
       [](Editor& e) { cover(e, 1, "Cover all by "); }, needs_layer},
      {"skin.layer_uncover", "Clear mask", "", "Layers",
       "The active layer covers nothing; what was painted on it is gone.",
       [](Editor& e) { cover(e, 0, "Clear mask of "); }, needs_layer},
  };
}

}  // namespace limber::editor
