// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/compare_wipe.h"

#include <cmath>

namespace limber::editor {

float wipe_line(const Editor& editor, const Rect& rect) {
  return std::round(glm::mix(rect.low.x, rect.high.x, editor.comparison.share));
}

bool over_side_a(const Editor& editor, const ViewPlace& place) {
  if (!editor.views->other_scene) return false;
  return editor.layout.by_sides ? place.side_a : editor.input.pointer.x < wipe_line(editor, place.rect);
}

const render::Scene& scene_of(const Editor& editor, const ViewPlace& place) {
  return place.side_a && editor.views->other_scene ? *editor.views->other_scene : editor.views->scene;
}

const render::Scene& scene_at_pointer(const Editor& editor, const ViewPlace& place) {
  return over_side_a(editor, place) ? *editor.views->other_scene : editor.views->scene;
}

const render::View3D& body_at_pointer(const Editor& editor, const ViewPlace& place) {
  const BodyView& body = editor.views->body;
  return over_side_a(editor, place) && body.other ? *body.other : *body.picture;
}

}  // namespace limber::editor
