// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/frame_all.h"

#include "editor/context/context.h"
#include "editor/context/preferences.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/ui.h"

namespace limber::editor {

void frame_all(Context& context, bool animated) {
  Views& views = *context.views;
  const Box box = tissue_box(views, shown_document(context), std::nullopt);
  const Rect* place = context.screen->layout.place_of(ViewId::Body);
  const double aspect = place && place->height() > 0 ? place->width() / place->height() : 1.5;
  const render::Camera framed = render::framing(views.body.camera, box.low, box.high, aspect);
  if (animated && !context.preferences->reduce_motion)
    views.body.move = CameraMove{views.body.camera, framed, context.ui->now};
  else views.body.camera = framed;
  if (!animated) views.cross_hair = middle_of_body(context.document(), box);
  for (SliceState& slice : views.slices) {
    slice.fitted = false;
    if (const Rect* shown = context.screen->layout.place_of(view_of(slice.camera.axis))) fit(slice, box, shown->size());
  }
  context.ui->touch();
}

}  // namespace limber::editor
