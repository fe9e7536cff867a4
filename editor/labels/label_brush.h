// SPDX-License-Identifier: AGPL-3.0-or-later
// The settings of the label brush, which paints the labels of the selected tissue, and its running stroke. They are not
// part of the document. The brush's radius and place are those of the weight brushes (editor/skin/painting.h).
#pragma once

#include <memory>
#include <string>

#include "core/label_edit/label_stroke.h"
#include "editor/context/layout.h"
#include "editor/context/views.h"

namespace limber::editor {

// The voxels that a stroke may paint over.
enum class PaintOver {
  All,
  Air,
  Tissue,      // all but air
  Underneath,  // only voxels with the label on which the stroke begins
};

struct LabelBrush {
  bool on = false;  // true: strokes paint labels instead of weights
  PaintOver over = PaintOver::All;
  Erased erased = Erased::Surroundings;
  bool flat = false;  // true: in slices, strokes paint only the voxels of the slice
  // If true and an image is shown, strokes change only voxels whose value in the image lies in [low, high].
  bool in_range = false;
  double low = 150, high = 3000;  // the usual bone of a CT, Hounsfield units

  struct Running {
    std::unique_ptr<LabelStroke> stroke;
    ViewPlace view;
    glm::vec2 pixel{0};  // position of the pointer up to which the stroke has painted
    std::string label;   // the name of the edit
  };
  std::shared_ptr<Running> running;  // null: no stroke is being painted

  // Returns whether a volume is the one that the running stroke paints.
  bool paints(const std::shared_ptr<const LabelVolume>& volume) const {
    return running && volume == running->stroke->volume();
  }
};

// Shows the running stroke's labels in this frame's scene.
void show_label_stroke(Views& views, const LabelBrush& brush);

}  // namespace limber::editor
