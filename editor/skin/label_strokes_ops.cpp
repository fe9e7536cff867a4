// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the label brush: switch it on, and set what its strokes change.
#include "editor/context/operator_polls.h"
#include "editor/labels/label_brush.h"
#include "editor/labels/label_edits.h"
#include "editor/seams/seam_view.h"
#include "editor/skin/label_strokes.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

LabelBrush& brush_of(const Editor& editor) { return *editor.skin->painting->labels; }

Operator over(const char* id, const char* label, const char* description, PaintOver over) {
  return {id,          label,
          "",          "Labels",
          description, [over](Editor& e) { brush_of(e).over = over; },
          nullptr,     [over](const Editor& e) { return brush_of(e).over == over; }};
}

Operator erasing(const char* id, const char* label, const char* description, Erased erased) {
  return {id,          label,
          "",          "Labels",
          description, [erased](Editor& e) { brush_of(e).erased = erased; },
          nullptr,     [erased](const Editor& e) { return brush_of(e).erased == erased; }};
}

void toggle_range(Editor& editor) {
  LabelBrush& brush = brush_of(editor);
  brush.in_range = !brush.in_range;
  if (brush.in_range) begin_range(editor);
}

// Switches the label brush on or off. If a workspace other than Skin is shown, always switches the brush on.
void toggle_brush(Editor& editor) {
  LabelBrush& brush = brush_of(editor);
  const bool leads_here = editor.workspace != Workspace::Skin;
  editor.workspace = Workspace::Skin;
  brush.on = leads_here || !brush.on;
  if (brush.on) editor.seams->brush = false;
  if (const std::string why = needs_edited_tissue(editor); leads_here && !why.empty())
    editor.messages.info("Label brush", why);
  editor.touch();
}

void pick_tissue(Editor& editor) {
  const Label label = editor.views->hover.label;
  select_tissue(editor, label, false);
  editor.messages.info("Label brush", "Paints " + shown_name(*editor.document().tissues->find(label)));
}

}  // namespace

std::vector<Operator> label_brush_operators() {
  return {
      {"labels.brush", "Label brush", icon::kLabelBrush, "Labels",
       "Paint the selected tissue's labels, in slices and on the body. Hold Ctrl to erase them. Select any other brush "
       "to paint weights again. Switches to the Skin workspace.",
       toggle_brush, needs_volume, [](const Editor& e) { return e.workspace == Workspace::Skin && brush_of(e).on; }},
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
       [](Editor& e) { brush_of(e).flat = !brush_of(e).flat; }, nullptr,
       [](const Editor& e) { return brush_of(e).flat; }},
      {"labels.in_range", "Only in a value range", "", "Labels",
       "Change only voxels whose value in the shown image lies in a range, such as bone in a CT.", toggle_range,
       [](const Editor& e) {
         return e.views->image ? std::string() : std::string("Open an image first: File > Import > Image");
       },
       [](const Editor& e) { return brush_of(e).in_range; }},
      {"labels.pick", "Pick tissue to paint", icon::kPick, "Labels",
       "Select the tissue under the pointer, so that the label brush paints it.", pick_tissue,
       [](const Editor& e) {
         const Document& document = e.document();
         return e.views->hover.inside && document.tissues && document.tissues->find(e.views->hover.label)
                    ? std::string()
                    : std::string("Put the pointer on the body");
       }},
  };
}

}  // namespace limber::editor
