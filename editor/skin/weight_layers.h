// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits the weight layers of the document, and the weights of the active layer. The document's weights are the
// composition of its layers. Only the functions of this file change layers or weights, so that both stay consistent.
// The layers of a large body are composed in a job, and the document changes when the job ends.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/project/document.h"
#include "core/skin/weight_layers.h"

namespace limber::editor {

struct Context;

// Replaces the document's weights. If the document has layers for the same body and bones, the new weights become the
// base below these layers. Otherwise the layers are removed.
void set_weights(Document& document, std::shared_ptr<const SkinWeights> weights);

// The weights that strokes and edits change: the weights of the active layer, the base weights below all layers, or the
// weights of a document without layers.
struct LayerToEdit {
  std::shared_ptr<const WeightLayers> layers;  // the document's layers; null: no layers
  // Index of the active layer; no value: the base weights below all layers are active, or there are no layers.
  std::optional<std::size_t> layer;
  // Weights before the edit; if a layer is active, its weights composed with those of all layers below it.
  std::shared_ptr<const SkinWeights> weights;
  std::shared_ptr<const SkinWeights> came_out;  // composed weights of all layers: the document's weights
};
// Returns the weights that a stroke or an edit would change now. The document must have weights.
LayerToEdit layer_to_edit(Context& context);
// The result of an edit. after: the edited weights of the layer; layers: the document's layers with this edit; weights:
// their composed weights. edited_layers() takes long for a large change, so a job calls it in its own thread.
struct EditedLayers {
  std::shared_ptr<const SkinWeights> after;
  std::shared_ptr<const WeightLayers> layers;
  std::shared_ptr<const SkinWeights> weights;
};
EditedLayers edited_layers(const LayerToEdit& edited, std::shared_ptr<const SkinWeights> after);
// Returns the document `now` with the edited layers and weights. Throws Error if the document's layers or weights have
// changed since layer_to_edit() returned `edited`.
Document with_edited(const Document& now, const LayerToEdit& edited, const EditedLayers& made);
// Commits the edited layers and weights as one edit.
void commit_weights(Context& context, const std::string& label, const LayerToEdit& edited, const EditedLayers& made);

// Returns the index of the layer that strokes and edits change; nothing if they change the base, or if there are no
// layers.
std::optional<std::size_t> active_layer(const Context& context);
void choose_layer(Context& context, std::optional<std::size_t> layer);
// Returns why the active layer cannot be painted ("The layer Elbow is hidden"); "" when it can.
std::string why_not_paint_layer(const Context& context);

void show_layer(Context& context, std::size_t layer, bool visible);
void rename_layer(Context& context, std::size_t layer, const std::string& name);
void set_layer_opacity(Context& context, std::size_t layer, double opacity);

// Commits the layers as one edit. If the list has no layer, the base becomes the document's weights.
void commit_layers(Context& context, const std::string& label, WeightLayers next);

}  // namespace limber::editor
