// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the label brush: switch it on, and set what its strokes change.
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/labels/label_brush.h"
#include "editor/labels/label_edits.h"
#include "editor/seams/seam_view.h"
#include "editor/skin/label_strokes.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

LabelBrush& brush_of(const Context& context) { return *context.skin->painting->labels; }

Operator over(const char* id, const char* label, const char* description, PaintOver over) {
  return {id,          label,
          "",          "Labels",
          description, [over](Context& c) { brush_of(c).over = over; },
          nullptr,     [over](const Context& c) { return brush_of(c).over == over; }};
}

Operator erasing(const char* id, const char* label, const char* description, Erased erased) {
  return {id,          label,
          "",          "Labels",
          description, [erased](Context& c) { brush_of(c).erased = erased; },
          nullptr,     [erased](const Context& c) { return brush_of(c).erased == erased; }};
}

void toggle_range(Context& context) {
  LabelBrush& brush = brush_of(context);
  brush.in_range = !brush.in_range;
  if (brush.in_range) begin_range(context);
}

// Switches the label brush on or off. If a workspace other than Skin is shown, always switches the brush on.
void toggle_brush(Context& context) {
  LabelBrush& brush = brush_of(context);
  const bool leads_here = context.workspace() != Workspace::Skin;
  context.screen->workspace = Workspace::Skin;
  brush.on = leads_here || !brush.on;
  if (brush.on) context.seams->brush = false;
  if (const std::string why = needs_edited_tissue(context); leads_here && !why.empty())
    context.messages->info("Label brush", why);
  context.ui->touch();
}

void pick_tissue(Context& context) {
  const Label label = context.views->hover.label;
  select_tissue(context, label, false);
  context.messages->info("Label brush", "Paints " + shown_name(*context.document().tissues->find(label)));
}

}  // namespace

std::vector<Operator> label_brush_operators() {
  return {
      {"labels.brush", "Label brush", icon::kLabelBrush, "Labels",
       "Paint the selected tissue's labels, in slices and on the body. Hold Ctrl to erase them. Select any other brush "
       "to paint weights again. Switches to the Skin workspace.",
       toggle_brush, needs_volume, [](const Context& c) { return c.workspace() == Workspace::Skin && brush_of(c).on; }},
      over("labels.over_all", "Paint over all", "Paint over every tissue and over air.", PaintOver::All),
      over("labels.over_air", "Paint over air", "Paint only where there is air.", PaintOver::Air),
      over("labels.over_tissue", "Paint over tissue", "Paint only over other tissue, never over air.",
           PaintOver::Tissue),
      over("labels.over_underneath", "Paint over one tissue",
           "Paint only over the tissue, or the air, on which the stroke begins.", PaintOver::Underneath),
      erasing("labels.erase_to_surroundings", "Erase to surroundings",
              "Erased voxels become the tissue or air around them.", Erased::Surroundings),
      erasing("labels.erase_to_air", "Erase to air", "Erased voxels become air.", Erased::Air),
      {"labels.flat", "Only one slice", "", "Labels",
       "In slices, paint only voxels of the shown slice. If switched off, the brush is a ball and paints neighbouring "
       "slices too.",
       [](Context& c) { brush_of(c).flat = !brush_of(c).flat; }, nullptr,
       [](const Context& c) { return brush_of(c).flat; }},
      {"labels.in_range", "Only in a value range", "", "Labels",
       "Change only voxels whose value in the shown image lies in a range, such as bone in a CT.", toggle_range,
       [](const Context& c) {
         return c.views->image ? std::string() : std::string("Open an image first: File > Import > Image");
       },
       [](const Context& c) { return brush_of(c).in_range; }},
      {"labels.pick", "Pick tissue to paint", icon::kPick, "Labels",
       "Select the tissue under the pointer, so that the label brush paints it.", pick_tissue,
       [](const Context& c) {
         const Document& document = c.document();
         return c.views->hover.inside && document.tissues && document.tissues->find(c.views->hover.label)
                    ? std::string()
                    : std::string("Put the pointer on the body");
       }},
  };
}

}  // namespace limber::editor
