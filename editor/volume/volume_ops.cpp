// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that prepare the volume, such as Crop to tissue. Operators with settings open a form first. Each operator
// runs as a job and makes one edit.
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/context/selection.h"
#include "editor/volume/volume_edits.h"

#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/prepare/prepare.h"
#include "editor/context/operator_polls.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/ui/icons.h"
#include "editor/volume/statistics_dialog.h"

namespace limber::editor {

namespace {

using Fields = std::vector<FormField>;

constexpr double kMostVoxels = 2e9;

std::string trimmed(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

void ask_regrid(Context& context) {
  const Grid& grid = context.document().volume->grid;
  const double finest = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  const auto outcome = [](const Context& c, const Fields& fields) {
    const Grid& old = c.document().volume->grid;
    const glm::dvec3 size = glm::ceil(glm::dvec3(old.size) * old.spacing / fields[0].value - 1e-6);
    const double voxels = size.x * size.y * size.z;
    if (voxels > kMostVoxels)
      throw Error("too many voxels", trimmed(voxels / 1e6) + " million", "enter a larger spacing");
    return "From " + size_text(old.size) + " to " + size_text(glm::ivec3(size)) + " voxels, " +
           grouped(static_cast<std::int64_t>(voxels * 2 / 1e6)) + " MB." +
           (c.document().weights ? " The weights are lost; compute them again." : "");
  };
  const auto act = [](Context& c, const Fields& fields) {
    const double spacing = fields[0].value;
    start_preparation(c, {"Resize voxels to " + trimmed(spacing) + " mm",
                          [spacing](const LabelVolume& v, Progress& p) { return regrid(v, glm::dvec3(spacing), p); }});
  };
  context.dialogs->open(
      make_form({"Resize voxels",
                 "Resample the volume to cubic voxels of another size. Thin layers stay closed.",
                 "Resize voxels",
                 {number_of("Spacing", "The edge length of a new voxel.", finest, 0.05, 50, "%.3g", "mm")},
                 outcome,
                 act}));
}

Operator flip_operator(const char* id, const char* label, int axis, const char* description) {
  return {id,
          label,
          icon::kMirror,
          "Prepare",
          description,
          [axis, label = std::string(label)](Context& c) {
            start_preparation(c, {label, [axis](const LabelVolume& v, Progress&) { return flip(v, axis); }, true});
          },
          needs_volume};
}

void ask_orient(Context& context) {
  const auto code_of = [](const Fields& fields) {
    std::string code;
    for (const FormField& field : fields) code += field.choices[field.chosen][0];
    return code;
  };
  const std::vector<std::string> directions = {"Left", "Right", "Posterior", "Anterior", "Superior", "Inferior"};
  const auto outcome = [code_of](const Context&, const Fields& fields) {
    if (fields[0].chosen / 2 == fields[1].chosen / 2 || fields[0].chosen / 2 == fields[2].chosen / 2 ||
        fields[1].chosen / 2 == fields[2].chosen / 2)
      throw Error("two voxel axes point along the same body axis", code_of(fields),
                  "select a different body axis for each voxel axis");
    return "Voxel axes " + code_of(fields) + ". The voxels are not resampled and stay where they are.";
  };
  const auto act = [code_of](Context& c, const Fields& fields) {
    const std::string code = code_of(fields);
    start_preparation(c, {"Orient to " + code, [code](const LabelVolume& v, Progress&) { return reorient(v, code); }});
  };
  context.dialogs->open(make_form(
      {"Orient",
       "Change the order and direction of the voxel axes. Select the side of the body that each axis points to.",
       "Orient",
       {choice_of("Columns (x)", "The side to which the first voxel axis points.", directions, 0),
        choice_of("Rows (y)", "The side to which the second voxel axis points.", directions, 2),
        choice_of("Slices (z)", "The side to which the third voxel axis points.", directions, 4)},
       outcome,
       act}));
}

std::string needs_clip_box(const Context& context) {
  if (!context.document().volume) return "Open a volume first";
  return context.document().visibility && context.document().visibility->clip_box.enabled
             ? ""
             : "Switch the clip box on first";
}

void crop_to_clip_box(Context& context) {
  const ClipBox box = context.document().visibility->clip_box;
  const glm::ivec3 low(glm::ceil(box.low - 1e-9)), high(glm::floor(box.high + 1e-9));
  start_preparation(context,
                    {"Crop to clip box", [low, high](const LabelVolume& v, Progress&) { return crop(v, low, high); }});
}

void ask_pad(Context& context) {
  const auto outcome = [](const Context& c, const Fields& fields) {
    const glm::ivec3 size = c.document().volume->grid.size + 2 * static_cast<int>(std::lround(fields[0].value));
    return "To " + size_text(size) + " voxels." +
           (c.document().weights ? " The weights are lost; compute them again." : "");
  };
  const auto act = [](Context& c, const Fields& fields) {
    const int voxels = static_cast<int>(std::lround(fields[0].value));
    start_preparation(c, {"Pad by " + std::to_string(voxels) + " voxels",
                          [voxels](const LabelVolume& v, Progress&) { return pad(v, voxels); }});
  };
  context.dialogs->open(
      make_form({"Pad",
                 "Add air on every side, so that a posed limb has room.",
                 "Pad",
                 {number_of("Margin", "Voxels of air to add on each of the six sides.", 8, 1, 500, "%.0f", "voxels")},
                 outcome,
                 act}));
}

void ask_merge(Context& context) {
  std::vector<std::string> names;
  std::vector<Label> labels;
  int chosen = 0;
  for (const Tissue& tissue : context.document().tissues->tissues) {
    if (context.selection->tissue == tissue.label) chosen = static_cast<int>(names.size());
    names.push_back(tissue.name + " (" + std::to_string(tissue.label) + ")");
    labels.push_back(tissue.label);
  }
  names.push_back("Air");
  labels.push_back(0);
  const auto outcome = [](const Context&, const Fields& fields) {
    if (fields[0].chosen == fields[1].chosen)
      throw Error("both tissues are the same", fields[0].choices[fields[0].chosen], "select another tissue");
    if (fields[0].chosen + 1 == std::ssize(fields[0].choices))
      throw Error("air cannot become tissue", "Merge", "select a tissue to merge");
    return "Every voxel of " + fields[0].choices[fields[0].chosen] + " becomes " + fields[1].choices[fields[1].chosen] +
           ".";
  };
  const auto act = [labels](Context& c, const Fields& fields) {
    const Label from = labels[fields[0].chosen], into = labels[fields[1].chosen];
    start_preparation(c, {"Merge " + fields[0].choices[fields[0].chosen],
                          [from, into](const LabelVolume& v, Progress&) { return merge_labels(v, from, into); }});
  };
  context.dialogs->open(
      make_form({"Merge tissues",
                 "Turn all voxels of one tissue into another tissue.",
                 "Merge",
                 {choice_of("Tissue", "The tissue whose voxels change.", names, chosen),
                  choice_of("Merge into", "The tissue that the voxels become.", names, chosen == 0 ? 1 : 0)},
                 outcome,
                 act}));
}

void ask_specks(Context& context) {
  const auto act = [](Context& c, const Fields& fields) {
    const auto voxels = static_cast<std::int64_t>(std::llround(fields[0].value));
    start_preparation(c, {"Remove specks below " + std::to_string(voxels) + " voxels",
                          [voxels](const LabelVolume& v, Progress&) { return drop_specks(v, voxels); }});
  };
  context.dialogs->open(make_form(
      {"Remove specks",
       "Replace small pieces that are separate from the rest of their tissue by the label around them.",
       "Remove",
       {number_of("Smaller than", "Pieces with fewer voxels than this are replaced.", 10, 2, 100000, "%.0f", "voxels")},
       nullptr,
       act}));
}

std::string needs_tissues(const Context& context) {
  if (!context.document().volume || !context.document().tissues) return "Open a volume first";
  return context.document().tissues->tissues.empty() ? "The volume has no tissue: add a tissue first" : "";
}

}  // namespace

std::vector<Operator> prepare_operators() {
  return {
      {"prepare.regrid", "Resize voxels...", icon::kVolume, "Prepare", "Resample the volume to voxels of another size.",
       ask_regrid, needs_volume},
      {"prepare.orient", "Orient...", icon::kRotate, "Prepare",
       "Change the order and direction of the voxel axes. The voxels keep their positions in space.", ask_orient,
       needs_volume},
      flip_operator("prepare.flip_x", "Flip left and right", 0, "Mirror the body from left to right."),
      flip_operator("prepare.flip_y", "Flip front and back", 1, "Mirror the body from front to back."),
      flip_operator("prepare.flip_z", "Flip head and feet", 2,
                    "Mirror the body along its length: head and feet change places."),
      {"prepare.crop", "Crop to tissue", icon::kClip, "Prepare", "Remove the air around the tissue from the volume.",
       [](Context& c) {
         start_preparation(c, {"Crop to tissue", [](const LabelVolume& v, Progress&) { return crop_to_tissue(v); }});
       },
       needs_volume},
      {"prepare.crop_to_clip_box", "Crop to clip box", icon::kClip, "Prepare",
       "Remove everything outside the clip box from the volume.", crop_to_clip_box, needs_clip_box},
      {"prepare.pad", "Pad...", icon::kFullScreen, "Prepare", "Add air on every side of the volume.", ask_pad,
       needs_volume},
      {"prepare.merge", "Merge tissues...", icon::kTissues, "Prepare",
       "Turn all voxels of one tissue into another tissue.", ask_merge, needs_tissues},
      {"prepare.specks", "Remove specks...", icon::kFilter, "Prepare",
       "Replace small stray pieces of a tissue by the label around them.", ask_specks, needs_volume},
      {"prepare.statistics", "Statistics", icon::kTable, "Prepare",
       "Show each tissue's number of voxels, volume and number of separate pieces.",
       [](Context& c) { c.dialogs->open(open_statistics(c)); }, needs_tissues},
  };
}

}  // namespace limber::editor
