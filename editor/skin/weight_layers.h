// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits the weight layers of the document, and the weights of the active layer. The document's weights are the
// composition of its layers. Only these functions change the layers or the weights, so that the two stay consistent. A
// large body is composed in a job, and the document changes when the job is done.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/project/document.h"
#include "core/skin/weight_layers.h"

namespace limber::editor {

struct Editor;

// Replaces the document's weights. If the document's layers belong to the same body and bones, the new weights become
// the base below them; otherwise the layers are removed.
void set_weights(Document& document, std::shared_ptr<const SkinWeights> weights);

// The weights that strokes and edits change: those of the active layer, of the base, or of a document without layers.
struct LayerToEdit {
  std::shared_ptr<const WeightLayers> layers;   // the document's layers; null: it has none
  std::optional<std::size_t> layer;             // the active layer's index; none: the base, or no layers
  std::shared_ptr<const SkinWeights> weights;   // the weights before the edit; for a layer, its canvas
  std::shared_ptr<const SkinWeights> came_out;  // the document's composed weights
};
// Returns the weights that an edit would change now. Needs weights in the document.
LayerToEdit layer_to_edit(Editor& editor);
// The result of an edit: the edited weights (`after`), and the document's layers and composed weights with them.
// edited_layers() takes long for a large change, so jobs call it themselves.
struct EditedLayers {
  std::shared_ptr<const SkinWeights> after;
  std::shared_ptr<const WeightLayers> layers;
  std::shared_ptr<const SkinWeights> weights;
};
EditedLayers edited_layers(const LayerToEdit& edited, std::shared_ptr<const SkinWeights> after);
// Returns the document with the edited layers and weights. Throws Error if its layers or weights were changed
// meanwhile.
Document with_edited(const Document& now, const LayerToEdit& edited, const EditedLayers& made);
// Commits the edited layers and weights as one edit.
void commit_weights(Editor& editor, const std::string& label, const LayerToEdit& edited, const EditedLayers& made);

// Returns the index of the painted layer; none: the base, or there are no layers.
std::optional<std::size_t> active_layer(const Editor& editor);
void choose_layer(Editor& editor, std::optional<std::size_t> layer);
// Returns why the active layer cannot be painted ("The layer Elbow is hidden"); "" when it can.
std::string why_not_paint_layer(const Editor& editor);

void show_layer(Editor& editor, std::size_t layer, bool visible);
void rename_layer(Editor& editor, std::size_t layer, const std::string& name);
void set_layer_opacity(Editor& editor, std::size_t layer, double opacity);

// Commits the layers as one edit. If no layer is left, the base becomes the document's weights.
void commit_layers(Editor& editor, const std::string& label, WeightLayers next);

}  // namespace limber::editor
