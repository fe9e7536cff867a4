// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/weight_layers.h"

#include <utility>

#include "core/base/error.h"
#include "core/project/job.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Largest number of tissue voxels whose layers are composed without a job (some 20 ms).
constexpr std::int64_t kComposedAtOnce = 300'000;

bool of_one_body(const SkinWeights& a, const SkinWeights& b) {
  bool same = a.bones() == b.bones() && a.size() == b.size() && a.chunk_count() == b.chunk_count();
  for (std::int64_t brick = 0; same && brick < a.chunk_count(); ++brick)
    same = a.chunk(brick).size() == b.chunk(brick).size();
  return same;
}

template <class T>
std::shared_ptr<const T> shared(T value) {
  return std::make_shared<const T>(std::move(value));
}

// Sets the document's layers and its weights. Without layers, the base weights become the document's weights.
//   came_out  the composed weights of all layers
void set_layers(Document& document, WeightLayers layers, std::shared_ptr<const SkinWeights> came_out) {
  if (layers.layers.empty()) {
    document.weights = layers.base;
    document.layers = nullptr;
  } else {
    document.weights = std::move(came_out);
    document.layers = shared(std::move(layers));
  }
}

}  // namespace

void set_weights(Document& document, std::shared_ptr<const SkinWeights> weights) {
  if (!document.layers || !of_one_body(*document.layers->base, *weights)) {
    document.layers = nullptr;
    document.weights = std::move(weights);
    return;
  }
  WeightLayers next = over_base(*document.layers, std::move(weights));
  auto came_out = shared(composed(next));
  set_layers(document, std::move(next), std::move(came_out));
}

std::optional<std::size_t> active_layer(const Context& context) {
  const auto& layers = context.document().layers;
  const auto& chosen = context.skin->painting->layer;
  if (!layers || !chosen) return std::nullopt;
  return std::min(*chosen, layers->layers.size() - 1);
}

void choose_layer(Context& context, std::optional<std::size_t> layer) {
  context.skin->painting->layer = layer;
  if (!layer) context.skin->painting->mask = false;
  context.ui->touch();
}

std::string why_not_paint_layer(const Context& context) {
  const auto layer = active_layer(context);
  if (!layer) return "";
  const WeightLayer& active = *context.document().layers->layers[*layer];
  if (!active.visible) return "The layer " + active.name + " is hidden: show it, or select another layer";
  if (active.opacity == 0)
    return "The layer " + active.name + " has an opacity of 0: raise the opacity, or select another layer";
  return "";
}

LayerToEdit layer_to_edit(Context& context) {
  const Document& document = context.document();
  LayerToEdit edited{document.layers, active_layer(context), document.weights, document.weights};
  if (!edited.layers) return edited;
  if (!edited.layer) {
    edited.weights = edited.layers->base;
    return edited;
  }
  auto& known = context.skin->painting->canvas;
  if (known.of != edited.layers || known.layer != *edited.layer)
    known = {edited.layers, *edited.layer, shared(canvas(*edited.layers, *edited.layer))};
  edited.weights = known.weights;
  return edited;
}

EditedLayers edited_layers(const LayerToEdit& edited, std::shared_ptr<const SkinWeights> after) {
  if (!edited.layers) return {after, nullptr, after};
  WeightLayers layers = *edited.layers;
  if (edited.layer)
    layers.layers[*edited.layer] = shared(painted_on(*layers.layers[*edited.layer], *edited.weights, *after));
  else layers = over_base(layers, after);
  auto came_out = shared(recomposed(layers, *edited.layers, *edited.came_out));
  return {std::move(after), shared(std::move(layers)), std::move(came_out)};
}

Document with_edited(const Document& now, const LayerToEdit& edited, const EditedLayers& made) {
  if (now.layers != edited.layers || now.weights != edited.came_out)
    throw Error("the weights were changed meanwhile", "changing weights", "repeat the edit");
  Document next = now;
  next.layers = made.layers;
  next.weights = made.weights;
  return next;
}

void commit_weights(Context& context, const std::string& label, const LayerToEdit& edited, const EditedLayers& made) {
  commit(context, label, with_edited(context.document(), edited, made));
  // Cache the new weights of the edited layer, composed with all layers below it. The next stroke on the layer starts
  // from them.
  if (edited.layer) context.skin->painting->canvas = {context.document().layers, *edited.layer, made.after};
}

void commit_layers(Context& context, const std::string& label, WeightLayers next) {
  const Document& document = context.document();
  const WeightLayers before = document.layers ? *document.layers : WeightLayers{document.weights, {}};
  std::int64_t voxels = 0;
  for (const std::int64_t brick : changed_bricks(next, before)) voxels += std::ssize(next.base->chunk(brick));
  if (voxels <= kComposedAtOnce) {
    Document changed = document;
    auto came_out = shared(recomposed(next, before, *document.weights));
    set_layers(changed, std::move(next), std::move(came_out));
    return commit(context, label, std::move(changed));
  }
  context.jobs->start(
      label, [label, next, before, of = document.layers, came_out = document.weights](Progress& progress) -> Edit {
        progress.update("weights", 0);
        auto made = shared(recomposed(next, before, *came_out));
        return [label, next, of, came_out, made](const Document& now) {
          if (now.layers != of || now.weights != came_out)
            throw Error("the layers were changed meanwhile", label, "repeat the edit");
          Document changed = now;
          set_layers(changed, next, made);
          return changed;
        };
      });
  context.ui->touch();
}

namespace {

template <class Change>
void change_layer(Context& context, std::size_t layer, const std::string& label, const Change& change) {
  WeightLayers next = *context.document().layers;
  WeightLayer changed = *next.layers[layer];
  change(changed);
  next.layers[layer] = shared(std::move(changed));
  commit_layers(context, label, std::move(next));
}

}  // namespace

void show_layer(Context& context, std::size_t layer, bool visible) {
  change_layer(context, layer, (visible ? "Show " : "Hide ") + context.document().layers->layers[layer]->name,
               [&](WeightLayer& l) { l.visible = visible; });
}

void rename_layer(Context& context, std::size_t layer, const std::string& name) {
  if (name.empty() || name == context.document().layers->layers[layer]->name) return;
  change_layer(context, layer, "Rename " + context.document().layers->layers[layer]->name,
               [&](WeightLayer& l) { l.name = name; });
}

void set_layer_opacity(Context& context, std::size_t layer, double opacity) {
  if (opacity == context.document().layers->layers[layer]->opacity) return;
  change_layer(context, layer, "Set opacity of " + context.document().layers->layers[layer]->name,
               [&](WeightLayer& l) { l.opacity = opacity; });
}

}  // namespace limber::editor
