// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that begin to measure the body, and operators that change the list of measurements.
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/platform_window.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/measure/measure_tool.h"
#include "editor/measure/measure_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_measurement(const Context& context) {
  const auto& all = context.document().measurements;
  return all && !all->empty() ? "" : "Measure something first";
}
std::string needs_chosen(const Context& context) {
  if (const std::string reason = needs_measurement(context); !reason.empty()) return reason;
  return chosen_measurement(context) ? "" : "Select a measurement in the sidebar first";
}

Operator tool_operator(const char* id, const char* label, const char* description, MeasureKind kind) {
  return {id,
          label,
          icon::kMeasure,
          "View",
          description,
          [kind](Context& c) {
            c.interaction->modal = begin_measuring(c, kind);
            c.interaction->modal_wrap = {};
          },
          needs_volume};
}

void remove_chosen(Context& context) {
  Document next = context.document();
  Measurements all = *next.measurements;
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(*chosen_measurement(context)));
  next.measurements = all.empty() ? nullptr : std::make_shared<const Measurements>(std::move(all));
  commit(context, "Delete measurement", std::move(next));
}

void remove_all(Context& context) {
  Document next = context.document();
  next.measurements = nullptr;
  commit(context, "Delete all measurements", std::move(next));
}

void ask_name(Context& context) {
  const std::string before = context.measures->chosen;
  FormRequest request;
  request.title = "Rename measurement";
  request.action = "Rename";
  request.fields = {text_of("Name", "", before)};
  request.outcome = [before](const Context& c, const std::vector<FormField>& fields) -> std::string {
    const std::string& name = fields[0].text;
    if (name.empty()) throw NotYet{"Type a name"};
    for (const Measurement& one : *c.document().measurements)
      if (one.name == name && name != before) throw NotYet{"Another measurement has this name"};
    return "";
  };
  request.act = [](Context& c, const std::vector<FormField>& fields) {
    Document next = c.document();
    Measurements all = *next.measurements;
    all[*chosen_measurement(c)].name = fields[0].text;
    next.measurements = std::make_shared<const Measurements>(std::move(all));
    commit(c, "Rename measurement", std::move(next));
    c.measures->chosen = fields[0].text;
  };
  context.dialogs->open(make_form(std::move(request)));
}

}  // namespace

std::vector<Operator> measure_operators() {
  return {
      {"measure.menu", "Measure", icon::kMeasure, "View",
       "Measure a distance, an angle, the girth of a limb or the thickness of a tissue.",
       [](Context& c) { c.menus->open_popup = "Measure"; }, needs_volume},
      tool_operator("measure.distance", "Measure distance",
                    "Click two points of the body in any view to measure their distance.", MeasureKind::Distance),
      tool_operator("measure.angle", "Measure angle",
                    "Click three points of the body to measure the angle at the second point.", MeasureKind::Angle),
      tool_operator("measure.girth", "Measure girth",
                    "Click a limb to measure its girth: at right angles to the nearest bone or, in a slice, in the "
                    "slice's plane.",
                    MeasureKind::Girth),
      tool_operator("measure.thickness", "Measure thickness",
                    "Click a tissue to measure its thickness: the shortest line through it.", MeasureKind::Thickness),
      {"measure.show", "Show measurements", "", "View", "Show or hide all measurements in the views.",
       [](Context& c) { c.measures->shown = !c.measures->shown; }, needs_measurement,
       [](const Context& c) { return c.measures->shown; }},
      {"measure.rename", "Rename measurement...", icon::kRename, "View", "Give the selected measurement another name.",
       ask_name, needs_chosen},
      {"measure.delete", "Delete measurement", icon::kTrash, "View", "Delete the selected measurement.", remove_chosen,
       needs_chosen},
      {"measure.clear", "Delete all measurements", "", "View", "Delete all measurements.", remove_all,
       needs_measurement},
      {"measure.copy", "Copy measurements", "", "View",
       "Copy all measurements to the clipboard, as a table for a spreadsheet.",
       [](Context& c) { c.host->set_clipboard(table_of_measurements(c)); }, needs_measurement},
  };
}

}  // namespace limber::editor
