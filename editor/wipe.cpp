// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/wipe.h"

#include <cmath>

namespace limber::editor {

float wipe_line(const Editor& editor, const Rect& rect) { return std::round(glm::mix(rect.low.x, rect.high.x, editor.comparison.share)); }

bool over_side_a(const Editor& editor, const ViewPlace& place) { return editor.views->other_scene && editor.input.pointer.x < wipe_line(editor, place.rect); }

const render::Scene& scene_at_pointer(const Editor& editor, const ViewPlace& place) { return over_side_a(editor, place) ? *editor.views->other_scene : editor.views->scene; }

const render::View3D& body_at_pointer(const Editor& editor, const ViewPlace& place) {
  const BodyView& body = editor.views->body;
  return over_side_a(editor, place) && body.other ? *body.other : *body.picture;
}

}  // namespace limber::editor
