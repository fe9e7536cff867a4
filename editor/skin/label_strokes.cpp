// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/label_strokes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/pointer_context.h"
#include "editor/context/view_projection.h"
#include "editor/context/workspace.h"
#include "editor/labels/label_edits.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

EditMask mask_of(const Context& context, const LabelBrush& brush, const BrushPlace& place, bool erases) {
  EditMask mask;
  const LabelVolume& volume = *context.document().volume;
  if (!erases && brush.over != PaintOver::All) {
    mask.labels.assign(65536, brush.over == PaintOver::Tissue);
    mask.labels[0] = brush.over == PaintOver::Air;
    if (brush.over == PaintOver::Underneath) {
      const glm::dvec3 at = voxel_from_world(volume.grid) * place.rest;
      mask.labels[volume.at_or_air(glm::ivec3(glm::floor(at + 0.5)))] = 1;
    }
  }
  if (brush.in_range && context.views->image) {
    mask.image = context.views->image->image;
    mask.low = brush.low, mask.high = brush.high;
  }
  return mask;
}

void paint_labels_to(Context& context, const glm::vec2& pixel) {
  Painting& painting = *context.skin->painting;
  LabelBrush::Running& running = *painting.labels->running;
  // In a slice, the brush paints the whole area between two pointer positions (a capsule) in one step. On the curved
  // surface of the body, it follows the pointer in short steps.
  const int steps =
      running.view.id == ViewId::Body
          ? std::clamp(static_cast<int>(glm::distance(pixel, running.pixel) / (4 * context.ui->look.scale)), 1, 24)
          : 1;
  for (int step = 1; step <= steps; ++step) {
    painting.place =
        label_brush_place(context, running.view, glm::mix(running.pixel, pixel, float(step) / float(steps)));
    if (painting.place) {
      running.stroke->to(painting.place->rest);
      running.unshown = box_around(running.unshown, running.stroke->last_box());
    } else {
      running.stroke->lift();
    }
  }
  running.pixel = pixel;
  context.ui->touch();
}

void drop_label_stroke(Context& context) {
  const auto running = std::exchange(context.skin->painting->labels->running, nullptr);
  show_unpainted(*context.views, *running->stroke);
  context.ui->touch();
}

void end_label_stroke(Context& context) {
  const auto running = context.skin->painting->labels->running;
  if (context.document().volume != running->stroke->before()) {
    drop_label_stroke(context);
    return context.messages->warn(running->label, "The stroke was not applied: the labels were changed meanwhile");
  }
  const LabelChange change = running->stroke->empty() ? LabelChange{} : running->stroke->change();
  if (change.empty()) {
    drop_label_stroke(context);
    return context.messages->info(running->label, "No voxel changed: check the Paint over setting of the brush");
  }
  context.skin->painting->labels->running.reset();
  show_painted(*context.views, *running->stroke);
  commit_labels(context, running->label, running->stroke->volume(), change);
}

}  // namespace

void begin_range(Context& context) {
  LabelBrush& brush = *context.skin->painting->labels;
  const LabelBrush usual;
  if (!context.views->image || brush.low != usual.low || brush.high != usual.high) return;
  const GreyLevels& image = *context.views->image->image;
  if (!looks_like_ct(image)) brush.low = image.least, brush.high = image.most();
}

std::string why_not_paint_labels(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  if (std::string why = needs_edited_tissue(context); !why.empty()) return why;
  return context.views->scene.pose ? "Show the body at rest first" : "";
}

std::optional<BrushPlace> label_brush_place(Context& context, const ViewPlace& view, const glm::vec2& pixel) {
  const render::Scene& scene = context.views->scene;
  if (view.id == ViewId::Body) return brush_place(context, view, pixel);
  if (!scene.volume) return std::nullopt;
  const glm::dvec3 point = world_of(slice_of(*context.views, view.id).camera, pixel - view.rect.low, view.rect.size());
  return BrushPlace{view.id, point, ViewProjection(context, view).towards_eye, point};
}

void begin_label_stroke(Context& context, bool erases) {
  const ViewPlace* view = hovered_view(context);
  if (!view || !why_not_paint_labels(context).empty()) return;
  const auto place = label_brush_place(context, *view, context.ui->input.pointer);
  if (!place) return;
  Painting& painting = *context.skin->painting;
  LabelBrush& brush = *painting.labels;
  const Tissue& tissue = edited_tissue(context);
  LabelStrokeSettings settings{
      .label = tissue.label, .erases = erases, .erased = brush.erased, .radius = painting.radius};
  if (brush.flat && view->id != ViewId::Body) settings.flat = place->normal;
  settings.mask = mask_of(context, brush, *place, erases);
  auto running = std::make_shared<LabelBrush::Running>();
  running->stroke = std::make_unique<LabelStroke>(context.document().volume, std::move(settings),
                                                  take_spare(brush, context.document().volume));
  running->view = *view;
  running->pixel = context.ui->input.pointer;
  running->label = (erases ? "Erase " : "Paint ") + shown_name(tissue);
  brush.running = running;
  paint_labels_to(context, context.ui->input.pointer);
  context.interaction->drag =
      Drag{MouseButton::Left, [](Context& c, const glm::vec2&) { paint_labels_to(c, c.ui->input.pointer); },
           end_label_stroke, drop_label_stroke};
}

}  // namespace limber::editor
