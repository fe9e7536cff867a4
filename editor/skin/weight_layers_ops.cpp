// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of weight layers: add, remove, rename, reorder, mask, merge.
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
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  return seen_weights(editor) ? "" : "Compute the weights first";
}

std::string needs_layer(const Editor& editor) {
  if (std::string why = needs_weights(editor); !why.empty()) return why;
  return active_layer(editor) ? "" : "Select a layer above the base first";
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
  // Move the new layer above the active one; without an active layer the new one stays on top.
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
       "Add an empty layer of weights above the active one. Painting on it changes no layer below.", add,
       needs_weights},
      {"skin.layer_remove", "Remove layer", icon::kTrash, "Layers",
       "Remove the active layer with everything painted on it.", remove, needs_layer},
      {"skin.layer_rename", "Rename layer", icon::kRename, "Layers", "Give the active layer another name.",
       [](Editor& e) {
         e.arrangement().sidebar = e.open_sections["Layers"] = true;
         e.wanted_section = "Layers";
         begin_renaming(e, "layers" + std::to_string(*active_layer(e)), name_of_active(e));
       },
       needs_layer},
      {"skin.layer_show", "Show layer", icon::kVisible, "Layers",
       "Show or hide the active layer. A hidden layer does not affect the weights.",
       [](Editor& e) { show_layer(e, *active_layer(e), !e.document().layers->layers[*active_layer(e)]->visible); },
       needs_layer,
       [](const Editor& e) { return active_layer(e) && e.document().layers->layers[*active_layer(e)]->visible; }},
      {"skin.layer_up", "Raise layer", icon::kUp, "Layers", "Move the active layer above the next higher layer.",
       [](Editor& e) { move(e, 1); },
       [](const Editor& e) {
         const std::string why = needs_layer(e);
         return !why.empty()                                                 ? why
                : *active_layer(e) + 1 == e.document().layers->layers.size() ? "This is already the top layer"
                                                                             : "";
       }},
      {"skin.layer_down", "Lower layer", icon::kDown, "Layers", "Move the active layer below the next lower layer.",
       [](Editor& e) { move(e, -1); },
       [](const Editor& e) {
         const std::string why = needs_layer(e);
         return !why.empty() ? why : *active_layer(e) == 0 ? "This is already the lowest layer" : "";
       }},
      {"skin.layer_merge", "Merge down", icon::kMergeDown, "Layers",
       "Merge the active layer into the layer or base below it. The combined weights do not change.", merge_down,
       needs_layer},
      {"skin.layer_mask", "Paint mask", icon::kMask, "Layers",
       "Paint the active layer's mask instead of weights. The Add brush makes the layer cover the layers below it, the "
       "Subtract brush reveals them.",
       [](Editor& e) { e.skin->painting->mask = !e.skin->painting->mask; }, needs_layer,
       [](const Editor& e) { return e.skin->painting->mask && active_layer(e).has_value(); }},
      {"skin.layer_cover", "Fill mask", "", "Layers",
       "Fill the active layer's mask, so that the layer covers the layers below in the whole body. Where the mask was "
       "empty, the layer gets a copy of the weights below.",
       [](Editor& e) { cover(e, 1, "Fill mask of "); }, needs_layer},
      {"skin.layer_uncover", "Clear mask", "", "Layers",
       "Clear the active layer's mask, so that the layer covers nothing. Everything painted on the layer is erased.",
       [](Editor& e) { cover(e, 0, "Clear mask of "); }, needs_layer},
  };
}

}  // namespace limber::editor
