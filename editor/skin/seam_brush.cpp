// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/seam_brush.h"

#include <algorithm>
#include <cmath>

#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/pointer_context.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr double kPixelStep = 4;  // a stroke is sampled each time the pointer has moved this far, pixels at scale 1

// Returns the line segment that cuts seams at the brush. In 3D it runs along the line of sight into the body; in a
// slice it is perpendicular to the slice and extends to both sides of it.
Blade blade_at(const ViewProjection& seen, const BrushPlace& place, double radius, const Grid& grid) {
  if (place.view != ViewId::Body)
    return {place.rest + radius * seen.towards_eye, place.rest - radius * seen.towards_eye};
  const glm::dvec3 to_eye = seen.direction_to_eye(place.seen);
  return {place.rest + glm::length(grid.spacing) * to_eye, place.rest - radius * to_eye};
}

void change_at(SeamView::Running& running, const ViewProjection& seen, const BrushPlace& place, double radius) {
  const Grid& grid = running.volume->grid;
  if (running.stroke == SeamStroke::Join) {
    running.faces += join_within(*running.seams, grid, place.rest, radius);
    return;
  }
  const Blade blade = blade_at(seen, place, radius, grid);
  if (running.blade) running.faces += cut_between(*running.seams, *running.volume, running.soft, *running.blade, blade);
  running.blade = blade;
}

void stroke_to(Context& context, const glm::vec2& pixel) {
  SeamView::Running& running = *context.seams->running;
  Painting& painting = *context.skin->painting;
  const ViewProjection seen(context, running.view);
  const int steps = std::max(
      1, static_cast<int>(std::ceil(glm::distance(pixel, running.pixel) / (kPixelStep * context.ui->look.scale))));
  for (int step = 1; step <= steps; ++step) {
    painting.place = brush_place(context, running.view, glm::mix(running.pixel, pixel, float(step) / float(steps)));
    if (painting.place) change_at(running, seen, *painting.place, painting.radius);
    else running.blade.reset();
  }
  running.pixel = pixel;
  context.ui->touch();
}

void drop_stroke(Context& context) {
  context.seams->running.reset();
  context.ui->touch();
}

void end_stroke(Context& context) {
  const auto running = context.seams->running;
  drop_stroke(context);
  const bool cuts = running->stroke == SeamStroke::Cut;
  if (running->faces == 0)
    return context.messages->info(
        cuts ? "No seam was cut" : "No seam was erased",
        cuts ? "Draw a line over soft tissue: the brush cuts along it" : "No seam lies within the brush");
  Document next = context.document();
  if (next.volume != running->volume) return;
  note_weights_source(context);
  next.seams = running->seams;
  context.history->commit(cuts ? "Cut seam" : "Erase seam", std::move(next));
}

}  // namespace

std::string why_not_cut(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  const Document& document = context.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  if (context.views->scene.pose) return "Show the body at rest first";
  return shown_seams(context) ? "" : "Find the seams first";
}

void begin_seam_stroke(Context& context, SeamStroke stroke) {
  const ViewPlace* view = hovered_view(context);
  const auto before = shown_seams(context);
  if (!view || !before || !why_not_cut(context).empty()) return;
  const Document& document = context.document();
  auto running = std::make_shared<SeamView::Running>();
  running->volume = document.volume;
  running->soft = soft_labels(*document.tissues);
  running->seams = *before ? std::make_shared<Seams>(**before) : std::make_shared<Seams>(document.volume->grid.size);
  running->stroke = stroke;
  running->view = *view;
  running->pixel = context.ui->input.pointer;
  context.seams->running = running;
  stroke_to(context, context.ui->input.pointer);
  context.interaction->drag =
      Drag{MouseButton::Left, [](Context& c, const glm::vec2&) { stroke_to(c, c.ui->input.pointer); }, end_stroke,
           drop_stroke};
}

}  // namespace limber::editor
