// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/compare_wipe.h"

#include <cmath>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/ui/ui.h"

namespace limber::editor {

float wipe_line(const Comparison& comparison, const Rect& rect) {
  return std::round(glm::mix(rect.low.x, rect.high.x, comparison.share));
}

bool over_side_a(const Context& context, const ViewPlace& place) {
  if (!context.views->other_scene) return false;
  return context.screen->layout.by_sides ? place.side_a
                                         : context.ui->input.pointer.x < wipe_line(context.comparison, place.rect);
}

const render::Scene& scene_of(const Context& context, const ViewPlace& place) {
  return place.side_a && context.views->other_scene ? *context.views->other_scene : context.views->scene;
}

const render::Scene& scene_at_pointer(const Context& context, const ViewPlace& place) {
  return over_side_a(context, place) ? *context.views->other_scene : context.views->scene;
}

const render::View3D& body_at_pointer(const Context& context, const ViewPlace& place) {
  const BodyView& body = context.views->body;
  return over_side_a(context, place) && body.other ? *body.other : *body.picture;
}

}  // namespace limber::editor
