// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators for the clip box and the clip plane. Switching them on and off is an edit, which can be undone.
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/views.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

Visibility visibility_of(const Document& document) { return document.visibility ? *document.visibility : Visibility{}; }

bool box_on(const Context& context) {
  return context.document().visibility && context.document().visibility->clip_box.enabled;
}
bool plane_on(const Context& context) {
  return context.document().visibility && context.document().visibility->clip_plane.enabled;
}

void commit_visibility(Context& context, const std::string& label, Visibility visibility) {
  Document next = context.document();
  next.visibility = std::make_shared<const Visibility>(std::move(visibility));
  commit(context, label, std::move(next));
}

void toggle_box(Context& context) {
  Visibility visibility = visibility_of(context.document());
  ClipBox& box = visibility.clip_box;
  box.enabled = !box.enabled;
  // When the box is switched on for the first time, it cuts away the body's front half to show the inside.
  if (box.low == box.high) {
    const glm::dvec3 size(context.document().volume->grid.size);
    box.low = glm::dvec3(-0.5);
    box.high = size - 0.5;
    const AffineTransform voxel = voxel_from_world(context.document().volume->grid);
    const glm::dvec3 front = voxel.linear * glm::dvec3(0, -1, 0), weight = glm::abs(front);
    const int axis = weight.x > weight.y && weight.x > weight.z ? 0 : weight.y > weight.z ? 1 : 2;
    (front[axis] > 0 ? box.high : box.low)[axis] = std::round(size[axis] / 2) - 0.5;
  }
  commit_visibility(context, box.enabled ? "Switch clip box on" : "Switch clip box off", visibility);
}

void toggle_plane(Context& context) {
  Visibility visibility = visibility_of(context.document());
  ClipPlane& plane = visibility.clip_plane;
  plane.enabled = !plane.enabled;
  if (plane.enabled) {
    plane.point = context.views->cross_hair;
    plane.normal = glm::normalize(render::eye_of(context.views->body.camera) - context.views->body.camera.centre);
  }
  commit_visibility(context, plane.enabled ? "Switch clip plane on" : "Switch clip plane off", visibility);
}

void reset_clips(Context& context) {
  Visibility visibility = visibility_of(context.document());
  visibility.clip_box = {};
  visibility.clip_plane = {};
  commit_visibility(context, "Reset clipping", visibility);
}

}  // namespace

std::vector<Operator> clip_operators() {
  return {
      {"view.clip_box", "Clip box", icon::kClip, "View",
       "Hide everything outside a box; drag the squares on its faces to move them.", toggle_box, needs_volume, box_on},
      {"view.clip_plane", "Clip plane", icon::kCut, "View",
       "Cut the volume open at the cross-hair, by a plane that faces the viewer.", toggle_plane, needs_volume,
       plane_on},
      {"view.reset_clipping", "Reset clipping", "", "View",
       "Remove the clip box and the clip plane, to show the whole volume.", reset_clips,
       [](const Context& c) { return box_on(c) || plane_on(c) ? std::string() : std::string("Nothing is clipped"); }},
  };
}

}  // namespace limber::editor
