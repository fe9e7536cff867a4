// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/labels/label_brush.h"

namespace limber::editor {

void show_label_stroke(Views& views, const LabelBrush& brush) {
  if (brush.running && views.scene.volume == brush.running->stroke->before())
    views.scene.volume = brush.running->stroke->volume();
}

}  // namespace limber::editor
