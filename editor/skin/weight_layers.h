// SPDX-License-Identifier: AGPL-3.0-or-later
// Layers of weights: which one strokes and edits go to, and edits of the layers themselves. The document's weights are
// what comes out of its layers; who changes one changes the other with it, by these functions alone.
//
// A body of many voxels is put together anew beside the editor; until that is done nothing has changed.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/project/document.h"
#include "core/skin/weight_layers.h"

namespace limber::editor {

struct Editor;

// Other weights in the document: below the layers where these are of the same body and bones, else in place of them
// too.
void set_weights(Document& document, std::shared_ptr<const SkinWeights> weights);

// What strokes and edits change.
struct LayerToEdit {
  std::shared_ptr<const WeightLayers> layers;   // the document's; null: it has none
  std::optional<std::size_t> layer;             // none: the base, or the weights themselves
  std::shared_ptr<const SkinWeights> weights;   // as they are before the edit: what that layer's canvas shows
  std::shared_ptr<const SkinWeights> came_out;  // the document's own
};
// The active layer's; the document has weights.
LayerToEdit layer_to_edit(Editor& editor);
// The two parts of the document after what is edited became `after`. A large change takes a while: jobs work it out
// themselves.
struct EditedLayers {
  std::shared_ptr<const SkinWeights> after;
  std::shared_ptr<const WeightLayers> layers;
  std::shared_ptr<const SkinWeights> weights;
};
EditedLayers edited_layers(const LayerToEdit& edited, std::shared_ptr<const SkinWeights> after);
// The document with them. Throws Error where its layers or weights were changed meanwhile.
Document with_edited(const Document& now, const LayerToEdit& edited, const EditedLayers& made);
// As one edit.
void commit_weights(Editor& editor, const std::string& label, const LayerToEdit& edited, const EditedLayers& made);

// The layer that is painted; none: the base, or there are no layers.
std::optional<std::size_t> active_layer(const Editor& editor);
void choose_layer(Editor& editor, std::optional<std::size_t> layer);
// "The layer Elbow is hidden"; "" where nothing keeps it from being painted.
std::string why_not_paint_layer(const Editor& editor);

void show_layer(Editor& editor, std::size_t layer, bool visible);
void rename_layer(Editor& editor, std::size_t layer, const std::string& name);
void set_layer_opacity(Editor& editor, std::size_t layer, double opacity);

// As one edit; no layers: the base alone stays.
void commit_layers(Editor& editor, const std::string& label, WeightLayers next);

}  // namespace limber::editor
