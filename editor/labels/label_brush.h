// SPDX-License-Identifier: AGPL-3.0-or-later
// The settings of the label brush, which paints the labels of the selected tissue, and its running stroke. They are
// not part of the document. The brush's radius and position are shared with the weight brushes
// (editor/skin/painting.h).
#pragma once

#include <future>
#include <memory>
#include <string>

#include "core/label_edit/label_stroke.h"
#include "core/tissue/tissue_table.h"
#include "editor/context/view_place.h"

namespace limber::editor {

struct Views;

// The voxels that a stroke may paint over.
enum class PaintOver {
  All,
  Air,
  Tissue,      // all voxels except air
  Underneath,  // only voxels with the label on which the stroke begins
};

struct LabelBrush {
  bool on = false;  // true: strokes paint labels instead of weights
  PaintOver over = PaintOver::All;
  Erased erased = Erased::Surroundings;
  bool flat = false;  // true: in slices, strokes paint only the voxels of the slice
  // If true and an image is shown, strokes change only voxels whose value in the image lies in [low, high].
  bool in_range = false;
  double low = 150, high = 3000;  // range of image values, by default those of bone in a CT, Hounsfield units

  struct Running {
    std::unique_ptr<LabelStroke> stroke;
    ViewPlace view;
    glm::vec2 pixel{0};  // position of the pointer up to which the stroke has painted
    std::string label;   // name of the edit that the stroke will become
    // Box of the voxels that have changed since the views were last updated; size 0: no voxel has changed.
    limber::VoxelBox unshown;
  };
  std::shared_ptr<Running> running;  // the stroke in progress; null: no stroke is being painted

  std::weak_ptr<const LabelVolume> last;  // the document's volume in the last frame, to notice when the volume changes

  // A copy of the document's volume for the next stroke. It is made in another thread while the brush is on, so that a
  // stroke on a large body begins at once.
  struct {
    std::weak_ptr<const LabelVolume> of;
    std::future<std::shared_ptr<LabelVolume>> copy;
  } spare;

  // Returns true if the volume is the one that the running stroke paints.
  bool paints(const std::shared_ptr<const LabelVolume>& volume) const {
    return running && volume == running->stroke->volume();
  }
};

// Shows the labels of the running stroke in this frame's scene. Uploads only the changed voxels to the GPU.
void show_label_stroke(Views& views, LabelBrush& brush);
// After a stroke, these functions make the views show the painted volume (show_painted) or again the volume before the
// stroke (show_unpainted). They upload only the voxels that differ.
void show_painted(Views& views, const LabelStroke& stroke);
void show_unpainted(Views& views, const LabelStroke& stroke);
// Returns the copy of the volume for the next stroke; null if there is none.
std::shared_ptr<LabelVolume> take_spare(LabelBrush& brush, const std::shared_ptr<const LabelVolume>& volume);
// Call once per frame with the document's volume. When a label edit is undone or redone, uploads only the voxels that
// differ from the last frame's volume.
void follow_label_edits(Views& views, LabelBrush& brush, const std::shared_ptr<const LabelVolume>& volume);

}  // namespace limber::editor
