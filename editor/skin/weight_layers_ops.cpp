// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of weight layers: add, remove, rename, reorder, mask, merge.
#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  return seen_weights(context) ? "" : "Compute the weights first";
}

std::string needs_layer(const Context& context) {
  if (std::string why = needs_weights(context); !why.empty()) return why;
  return active_layer(context) ? "" : "Select a layer above the base first";
}

WeightLayers layers_of(const Context& context) {
  const Document& document = context.document();
  return document.layers ? *document.layers : WeightLayers{document.weights, {}};
}

const std::string& name_of_active(const Context& context) {
  return context.document().layers->layers[*active_layer(context)]->name;
}

void add(Context& context) {
  WeightLayers next = layers_of(context);
  std::string name;
  for (int number = 1; name.empty() || std::any_of(next.layers.begin(), next.layers.end(),
                                                   [&](const auto& layer) { return layer->name == name; });
       ++number)
    name = "Layer " + std::to_string(number);
  next = with_new_layer(next, name);
  // Move the new layer above the active one; without an active layer the new one stays on top.
  const std::size_t at = active_layer(context) ? *active_layer(context) + 1 : next.layers.size() - 1;
  std::rotate(next.layers.begin() + static_cast<std::ptrdiff_t>(at), next.layers.end() - 1, next.layers.end());
  commit_layers(context, "Add " + name, std::move(next));
  choose_layer(context, at);
}

void remove(Context& context) {
  const std::size_t layer = *active_layer(context);
  WeightLayers next = layers_of(context);
  next.layers.erase(next.layers.begin() + static_cast<std::ptrdiff_t>(layer));
  commit_layers(context, "Remove " + name_of_active(context), std::move(next));
  choose_layer(context, layer > 0 ? std::optional(layer - 1) : std::nullopt);
}

void move(Context& context, int by) {
  const std::size_t layer = *active_layer(context), to = layer + static_cast<std::size_t>(by);
  WeightLayers next = layers_of(context);
  std::swap(next.layers[layer], next.layers[to]);
  commit_layers(context, (by > 0 ? "Raise " : "Lower ") + name_of_active(context), std::move(next));
  choose_layer(context, to);
}

void merge_down(Context& context) {
  const std::size_t layer = *active_layer(context);
  const std::string label = "Merge " + name_of_active(context) + " down";
  commit_layers(context, label, merged_down(layers_of(context), layer));
  choose_layer(context, layer > 0 ? std::optional(layer - 1) : std::nullopt);
}

void cover(Context& context, double share, const char* label) {
  const std::size_t layer = *active_layer(context);
  WeightLayers next = layers_of(context);
  next.layers[layer] = std::make_shared<const WeightLayer>(
      with_mask(next, layer, *tissue_voxels(*context.views, context.document()), {}, share));
  commit_layers(context, label + name_of_active(context), std::move(next));
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
       [](Context& c) {
         c.screen->arrangement().sidebar = c.ui->open_sections["Layers"] = true;
         c.ui->wanted_section = "Layers";
         begin_renaming(c.ui, "layers" + std::to_string(*active_layer(c)), name_of_active(c));
       },
       needs_layer},
      {"skin.layer_show", "Show layer", icon::kVisible, "Layers",
       "Show or hide the active layer. A hidden layer does not affect the weights.",
       [](Context& c) { show_layer(c, *active_layer(c), !c.document().layers->layers[*active_layer(c)]->visible); },
       needs_layer,
       [](const Context& c) { return active_layer(c) && c.document().layers->layers[*active_layer(c)]->visible; }},
      {"skin.layer_up", "Raise layer", icon::kUp, "Layers", "Move the active layer above the next higher layer.",
       [](Context& c) { move(c, 1); },
       [](const Context& c) {
         const std::string why = needs_layer(c);
         return !why.empty()                                                 ? why
                : *active_layer(c) + 1 == c.document().layers->layers.size() ? "This is already the top layer"
                                                                             : "";
       }},
      {"skin.layer_down", "Lower layer", icon::kDown, "Layers", "Move the active layer below the next lower layer.",
       [](Context& c) { move(c, -1); },
       [](const Context& c) {
         const std::string why = needs_layer(c);
         return !why.empty() ? why : *active_layer(c) == 0 ? "This is already the lowest layer" : "";
       }},
      {"skin.layer_merge", "Merge down", icon::kMergeDown, "Layers",
       "Merge the active layer into the layer or base below it. The combined weights do not change.", merge_down,
       needs_layer},
      {"skin.layer_mask", "Paint mask", icon::kMask, "Layers",
       "Paint the active layer's mask instead of weights. The Add brush makes the layer cover the layers below it, the "
       "Subtract brush reveals them.",
       [](Context& c) { c.skin->painting->mask = !c.skin->painting->mask; }, needs_layer,
       [](const Context& c) { return c.skin->painting->mask && active_layer(c).has_value(); }},
      {"skin.layer_cover", "Fill mask", "", "Layers",
       "Fill the active layer's mask, so that the layer covers the layers below in the whole body. Where the mask was "
       "empty, the layer gets a copy of the weights below.",
       [](Context& c) { cover(c, 1, "Fill mask of "); }, needs_layer},
      {"skin.layer_uncover", "Clear mask", "", "Layers",
       "Clear the active layer's mask, so that the layer covers nothing. Everything painted on the layer is erased.",
       [](Context& c) { cover(c, 0, "Clear mask of "); }, needs_layer},
  };
}

}  // namespace limber::editor
