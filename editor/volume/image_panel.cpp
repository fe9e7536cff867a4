// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Image" of the sidebar: the window of grey values, the opacity of the tissues over the image, and
// the method by which the 3D view renders the image.
#include <algorithm>
#include <array>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/input_fields.h"
#include "editor/volume/image_labels.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

// The operators that select how the 3D view renders the image, in the order of GreyRendering.
constexpr std::array kRenderings = {"image.render_bone", "image.render_muscle", "image.render_skin",
                                    "image.render_window", "image.render_maximum"};

// Draws a number field that changes its value during a drag, not only at the end of the drag.
void draw_number(Ui& ui, Column& column, const char* label, double low, double high, const char* unit, bool filled,
                 double& value) {
  bool committed = false;
  double number = value;
  if (!number_field(ui, label, column.property(label), number, low, high, filled ? "%.0f" : "%.4g", unit, filled,
                    committed))
    return;
  value = number;
  ui.touch();
}

void draw_windows(Context& context, Column& column) {
  std::vector<std::string> names{"Custom"};
  std::vector<const char*> ids{""};
  int chosen = 0;
  const auto add = [&](const char* id, const std::string& name) {
    if (const Operator* op = find_operator(context.operators, id); op && op->checked && op->checked(context))
      chosen = static_cast<int>(names.size());
    names.push_back(name);
    ids.push_back(id);
  };
  if (looks_like_ct(*context.views->image->image))
    for (const ImageWindow& window : ct_windows()) add(window.id, window.name);
  add("image.window_all", "All values");
  const Rect field = column.property("Window");
  const PathScope scope(context.ui, "Window");
  if (choice_field(context.ui, field, names, chosen) && chosen > 0) run(context, ids[static_cast<std::size_t>(chosen)]);
}

void draw_renderings(Context& context, Column& column) {
  std::vector<std::string> names;
  for (const char* id : kRenderings) {
    const std::string& label = find_operator(context.operators, id)->label;
    names.push_back(label.substr(0, label.rfind(" in 3D")));
  }
  int chosen = static_cast<int>(context.views->image->rendering);
  const Rect field = column.property("3D view");
  const PathScope scope(context.ui, "3D view");
  if (choice_field(context.ui, field, names, chosen)) run(context, kRenderings[static_cast<std::size_t>(chosen)]);
}

}  // namespace

void draw_image_section(Context& context, Column& column) {
  if (!context.views->image) return;
  if (column.begin_section("Image", context.views->image_path.filename().string())) {
    render::ShownGrey& image = *context.views->image;
    const double least = image.image->least, most = image.image->most(), range = std::max(most - least, 1e-6);
    const char* unit = looks_like_ct(*image.image) ? "HU" : "";
    column.space(6);
    draw_windows(context, column);
    draw_number(context.ui, column, "Level", least - range, most + range, unit, false, image.level);
    draw_number(context.ui, column, "Width", range / 5000, 2 * range, unit, false, image.width);
    double percent = 100.0 * double(image.tissues);
    draw_number(context.ui, column, "Tissue opacity", 0, 100, "%", true, percent);
    image.tissues = static_cast<float>(percent / 100);
    draw_renderings(context, column);
    if (const auto result = shown_result(context); result && !posed_image_of(*context.views, result->volume)) {
      const Rect note = column.row(36);
      put_wrapped(context.ui, context.ui->look.fonts.regular, context.ui->look.theme.text2,
                  note.low + glm::vec2(context.ui->look.px(10), context.ui->look.px(2)),
                  note.width() - context.ui->look.px(20),
                  "This result was made without the image; resample again to pose it.");
    }
    column.space(4);
    const Rect row = column.row(26);
    const float middle = std::round(row.low.x + row.width() * 0.62f), gap = context.ui->look.px(3),
                side = context.ui->look.px(10);
    // The button of the labels has the width that its name and its icon need, and closing the image takes the rest.
    const char* labels = labels_operator(context.views);
    operator_button(context, labels, {{row.low.x + side, row.low.y}, {middle - gap, row.high.y}},
                    find_operator(context.operators, labels)->label);
    operator_button(context, "image.close", {{middle + gap, row.low.y}, {row.high.x - side, row.high.y}}, "Close");
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
