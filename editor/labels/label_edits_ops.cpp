// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that edit the labels of the selected tissue: fill its holes, grow and shrink it, remove its islands, split
// it by a cut, and make a new tissue to paint with.
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/context/operator.h"
#include "editor/context/views.h"
#include "editor/labels/label_edits.h"

#include <cmath>

#include "core/label_edit/fill_holes.h"
#include "core/label_edit/grow_shrink.h"
#include "core/label_edit/islands.h"
#include "editor/context/document_edits.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/labels/split_tool.h"
#include "editor/ui/icons.h"
#include "editor/viewport/numeric_input.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

using Fields = std::vector<FormField>;

constexpr double kMm3PerMl = 1000;

std::string counted(std::int64_t number, const std::string& one, const std::string& many) {
  return grouped(number) + " " + (number == 1 ? one : many);
}
std::string voxels_of(const LabelChange& change) { return counted(change.voxel_count(), "voxel", "voxels"); }

FormField erased_choice() {
  return choice_of("Replace with", "What replaces the removed voxels: the tissue around them, or air.",
                   {"Surroundings", "Air"});
}
Erased erased_of(const FormField& field) { return field.chosen == 1 ? Erased::Air : Erased::Surroundings; }

// Opens a form for an edit of the selected tissue. The form edits this tissue even if the user selects another one
// before confirming.
void ask(Context& context, const std::string& title, const std::string& description, const std::string& action,
         Fields fields, std::function<FoundLabelEdit(const LabelVolume&, Label, const Fields&, Progress&)> find) {
  const Tissue tissue = edited_tissue(context);
  const std::string name = title + " " + shown_name(tissue);
  context.dialogs->open(make_form(
      {name, description, action, std::move(fields), nullptr,
       [name, label = tissue.label, find](Context& c, const Fields& answers) {
         start_label_edit(
             c, {name, [label, find, answers](const LabelVolume& v, Progress& p) { return find(v, label, answers, p); },
                 nullptr, std::nullopt});
       }}));
}

void ask_holes(Context& context) {
  ask(context, "Fill holes of", "Give the tissue the voxels that it encloses.", "Fill",
      {choice_of(
           "Hole content",
           "What the holes to fill contain. Air keeps holes that contain tissue, such as the marrow inside a bone.",
           {"Air", "Any tissue"}),
       number_of("Largest hole", "Volume of the largest hole to fill. 0 = fill holes of any size.", 0, 0, 1e5, "%.3g",
                 "ml")},
      [](const LabelVolume& volume, Label label, const Fields& fields, Progress&) -> FoundLabelEdit {
        FilledHoles found = fill_holes(
            volume, label, {.largest_volume = fields[1].value * kMm3PerMl, .only_air = fields[0].chosen == 0});
        const std::string left =
            found.left ? ", " + counted(found.left, "hole stays", "holes stay") + ": too large, or not all air" : "";
        const std::string note = found.filled == 0 ? "No hole was filled" + left
                                                   : counted(found.filled, "hole", "holes") + " filled with " +
                                                         voxels_of(found.change) + left;
        return {std::move(found.change), note};
      });
}

void ask_grow(Context& context) {
  const double step = std::max({context.document().volume->grid.spacing.x, context.document().volume->grid.spacing.y,
                                context.document().volume->grid.spacing.z});
  ask(context, "Grow", "Extend the tissue by a distance in all directions.", "Grow",
      {number_of("Distance", "How far the tissue's border moves. A distance shorter than a voxel changes nothing.",
                 step, 0.1, 100, "%.3g", "mm"),
       choice_of("Grow over", "The voxels that the tissue may grow over: all, only air, or only other tissue.",
                 {"All", "Air", "Tissue"})},
      [](const LabelVolume& volume, Label label, const Fields& fields, Progress& progress) -> FoundLabelEdit {
        EditMask mask;
        if (fields[1].chosen > 0) {
          mask.labels.assign(65536, fields[1].chosen == 2);
          mask.labels[0] = fields[1].chosen == 1;
        }
        LabelChange change = grown_label(volume, label, fields[0].value, mask, progress);
        const std::string note =
            change.empty() ? "No voxel changed: enter a larger distance" : voxels_of(change) + " more";
        return {std::move(change), note};
      });
}

void ask_shrink(Context& context) {
  const double step = std::max({context.document().volume->grid.spacing.x, context.document().volume->grid.spacing.y,
                                context.document().volume->grid.spacing.z});
  ask(context, "Shrink", "Shrink the tissue by a distance from all sides.", "Shrink",
      {number_of("Distance", "How far the tissue's border moves. A distance shorter than a voxel changes nothing.",
                 step, 0.1, 100, "%.3g", "mm"),
       erased_choice()},
      [](const LabelVolume& volume, Label label, const Fields& fields, Progress& progress) -> FoundLabelEdit {
        LabelChange change = shrunk_label(volume, label, fields[0].value, erased_of(fields[1]), progress);
        const std::string note =
            change.empty() ? "No voxel changed: enter a larger distance" : voxels_of(change) + " fewer";
        return {std::move(change), note};
      });
}

void ask_islands(Context& context) {
  ask(context, "Remove islands of", "Remove pieces of the tissue that are not connected to its largest pieces.",
      "Remove",
      {number_of("Pieces kept",
                 "Number of pieces to keep, the largest ones. 0 = keep all pieces of at least the smallest size.", 1, 0,
                 10000, "%.0f", "pieces"),
       number_of("Smallest size", "Pieces smaller than this are always removed.", 0, 0, 1e5, "%.3g", "ml"),
       erased_choice()},
      [](const LabelVolume& volume, Label label, const Fields& fields, Progress&) -> FoundLabelEdit {
        RemovedIslands found = remove_islands(volume, label,
                                              {.largest = static_cast<int>(std::lround(fields[0].value)),
                                               .least_volume = fields[1].value * kMm3PerMl,
                                               .erased = erased_of(fields[2])});
        const std::string kept = counted(found.kept, "piece stays", "pieces stay");
        const std::string note = found.removed == 0 ? "No island was removed: " + kept
                                                    : counted(found.removed, "island", "islands") + " removed with " +
                                                          voxels_of(found.change) + ", " + kept;
        return {std::move(found.change), note};
      });
}

void add_tissue(Context& context) {
  const Document& now = context.document();
  const Tissue tissue = new_tissue_like(*now.tissues, nullptr);
  Document next = now;
  next.tissues = with_tissue(*now.tissues, tissue);
  commit(context, "New tissue", std::move(next));
  select_tissue(context, tissue.label, false);
}

std::string needs_table(const Context& context) {
  return context.document().volume && context.document().tissues ? "" : "Open a volume first";
}

}  // namespace

std::vector<Operator> label_edit_operators() {
  return {
      {"labels.new_tissue", "New tissue", icon::kAdd, "Labels",
       "Add a tissue without voxels to the list and select it, to paint it with the label brush.", add_tissue,
       needs_table},
      {"labels.fill_holes", "Fill holes...", "", "Labels", "Give the selected tissue the voxels that it encloses.",
       ask_holes, needs_edited_tissue},
      {"labels.grow", "Grow...", "", "Labels", "Extend the selected tissue by a distance in mm.", ask_grow,
       needs_edited_tissue},
      {"labels.shrink", "Shrink...", "", "Labels", "Shrink the selected tissue by a distance in mm.", ask_shrink,
       needs_edited_tissue},
      {"labels.islands", "Remove islands...", "", "Labels",
       "Remove pieces of the selected tissue that are not connected to its largest pieces.", ask_islands,
       needs_edited_tissue},
      {"labels.split", "Split by a cut", icon::kCut, "Labels",
       "Cut the selected tissue along a line that you draw, in the direction of view. The smaller part becomes a new "
       "tissue.",
       [](Context& c) {
         c.interaction->modal = begin_split(c);
         c.interaction->modal_wrap = {};
       },
       [](const Context& c) {
         const std::string why = needs_edited_tissue(c);
         return why.empty() && c.views->scene.pose ? std::string("Show the body at rest first") : why;
       }},
  };
}

}  // namespace limber::editor
