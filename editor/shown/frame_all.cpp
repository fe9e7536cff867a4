// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/frame_all.h"

#include "editor/shown/shown_result.h"

namespace limber::editor {

void frame_all(Editor& editor, bool animated) {
  Views& views = *editor.views;
  const Box box = tissue_box(views, shown_document(editor), std::nullopt);
  const Rect* place = editor.layout.place_of(ViewId::Body);
  const double aspect = place && place->height() > 0 ? place->width() / place->height() : 1.5;
  const render::Camera framed = render::framing(views.body.camera, box.low, box.high, aspect);
  if (animated && !editor.preferences.reduce_motion)
    views.body.move = CameraMove{views.body.camera, framed, editor.now};
  else views.body.camera = framed;
  if (!animated) views.cross_hair = middle_of_body(editor.document(), box);
  for (SliceState& slice : views.slices) {
    slice.fitted = false;
    if (const Rect* shown = editor.layout.place_of(view_of(slice.camera.axis))) fit(slice, box, shown->size());
  }
  editor.touch();
}

}  // namespace limber::editor
