// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/label_strokes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "editor/context/pointer_context.h"
#include "editor/context/view_projection.h"
#include "editor/labels/label_edits.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "editor/volume/shown_image.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

EditMask mask_of(const Editor& editor, const LabelBrush& brush, const BrushPlace& place, bool erases) {
  EditMask mask;
  const LabelVolume& volume = *editor.document().volume;
  if (!erases && brush.over != PaintOver::All) {
    mask.labels.assign(65536, brush.over == PaintOver::Tissue);
    mask.labels[0] = brush.over == PaintOver::Air;
    if (brush.over == PaintOver::Underneath) {
      const glm::dvec3 at = voxel_from_world(volume.grid) * place.rest;
      mask.labels[volume.at_or_air(glm::ivec3(glm::floor(at + 0.5)))] = 1;
    }
  }
  if (brush.in_range && editor.views->image) {
    mask.image = editor.views->image->image;
    mask.low = brush.low, mask.high = brush.high;
  }
  return mask;
}

void paint_labels_to(Editor& editor, const glm::vec2& pixel) {
  Painting& painting = *editor.skin->painting;
  LabelBrush::Running& running = *painting.labels->running;
  // In a slice, the brush paints the whole capsule between two pointer positions in one step. On the curved surface of
  // the body, it follows the pointer in short steps.
  const int steps =
      running.view.id == ViewId::Body
          ? std::clamp(static_cast<int>(glm::distance(pixel, running.pixel) / (4 * editor.look.scale)), 1, 24)
          : 1;
  for (int step = 1; step <= steps; ++step) {
    painting.place =
        label_brush_place(editor, running.view, glm::mix(running.pixel, pixel, float(step) / float(steps)));
    if (painting.place) {
      running.stroke->to(painting.place->rest);
      running.unshown = box_around(running.unshown, running.stroke->last_box());
    } else {
      running.stroke->lift();
    }
  }
  running.pixel = pixel;
  editor.touch();
}

void drop_label_stroke(Editor& editor) {
  const auto running = std::exchange(editor.skin->painting->labels->running, nullptr);
  show_unpainted(*editor.views, *running->stroke);
  editor.touch();
}

void end_label_stroke(Editor& editor) {
  const auto running = editor.skin->painting->labels->running;
  if (editor.document().volume != running->stroke->before()) {
    drop_label_stroke(editor);
    return editor.messages.warn(running->label, "The stroke was not applied: the labels were changed meanwhile");
  }
  const LabelChange change = running->stroke->empty() ? LabelChange{} : running->stroke->change();
  if (change.empty()) {
    drop_label_stroke(editor);
    return editor.messages.info(running->label, "No voxel changed: check the Paint over setting of the brush");
  }
  editor.skin->painting->labels->running.reset();
  show_painted(*editor.views, *running->stroke);
  commit_labels(editor, running->label, running->stroke->volume(), change);
}

}  // namespace

void begin_range(Editor& editor) {
  LabelBrush& brush = *editor.skin->painting->labels;
  const LabelBrush usual;
  if (!editor.views->image || brush.low != usual.low || brush.high != usual.high) return;
  const GreyLevels& image = *editor.views->image->image;
  if (!looks_like_ct(image)) brush.low = image.least, brush.high = image.most();
}

std::string why_not_paint_labels(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  if (std::string why = needs_edited_tissue(editor); !why.empty()) return why;
  return editor.views->scene.pose ? "Show the body at rest first" : "";
}

std::optional<BrushPlace> label_brush_place(Editor& editor, const ViewPlace& view, const glm::vec2& pixel) {
  const render::Scene& scene = editor.views->scene;
  if (view.id == ViewId::Body) return brush_place(editor, view, pixel);
  if (!scene.volume) return std::nullopt;
  const glm::dvec3 point = world_of(slice_of(*editor.views, view.id).camera, pixel - view.rect.low, view.rect.size());
  return BrushPlace{view.id, point, ViewProjection(editor, view).towards_eye, point};
}

void begin_label_stroke(Editor& editor, bool erases) {
  const ViewPlace* view = hovered_view(editor);
  if (!view || !why_not_paint_labels(editor).empty()) return;
  const auto place = label_brush_place(editor, *view, editor.input.pointer);
  if (!place) return;
  Painting& painting = *editor.skin->painting;
  LabelBrush& brush = *painting.labels;
  const Tissue& tissue = edited_tissue(editor);
  LabelStrokeSettings settings{
      .label = tissue.label, .erases = erases, .erased = brush.erased, .radius = painting.radius};
  if (brush.flat && view->id != ViewId::Body) settings.flat = place->normal;
  settings.mask = mask_of(editor, brush, *place, erases);
  auto running = std::make_shared<LabelBrush::Running>();
  running->stroke = std::make_unique<LabelStroke>(editor.document().volume, std::move(settings),
                                                  take_spare(brush, editor.document().volume));
  running->view = *view;
  running->pixel = editor.input.pointer;
  running->label = (erases ? "Erase " : "Paint ") + shown_name(tissue);
  brush.running = running;
  paint_labels_to(editor, editor.input.pointer);
  editor.drag = Drag{MouseButton::Left, [](Editor& e, const glm::vec2&) { paint_labels_to(e, e.input.pointer); },
                     end_label_stroke, drop_label_stroke};
}

}  // namespace limber::editor
