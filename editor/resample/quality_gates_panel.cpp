// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the quality gates of the shown result with pass or fail, and its provenance: method, settings, inputs and
// times.
#include <algorithm>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/platform_window.h"
#include "editor/resample/results.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/icons.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

// Selects the tissue or bone whose value decided the quality gate.
void go_to_worst(Context& context, const QualityGate& gate) {
  const Document& document = context.document();
  if (document.tissues)
    for (const Tissue& tissue : document.tissues->tissues)
      if (tissue.name == gate.worst) return select_tissue(context, tissue.label, false);
  if (!document.armature) return;
  if (const auto bone = document.armature->find(gate.worst)) choose_bone(context, static_cast<int>(*bone));
}

void draw_gate(Context& context, Column& column, const QualityGate& gate) {
  const Look& look = context.ui->look;
  const Theme& theme = look.theme;
  const Rect row = column.row(24);
  const Pressed pressed = press_area(context.ui, gate.name, row);
  if (pressed.hovered) fill(row, theme.hover);
  const bool failed = gate.state == GateState::Failed, measured = gate.state != GateState::NotMeasured;
  const Colour colour = failed ? theme.error : measured ? theme.ok : theme.text2;
  put_icon(look.fonts.regular, colour, Rect{{row.low.x + look.px(8), row.low.y}, {row.low.x + look.px(26), row.high.y}},
           failed     ? icon::kFail
           : measured ? icon::kOk
                      : icon::kRemove);
  const std::string figure = measured ? gate.figure : "not checked";
  ImFont* font = measured ? look.fonts.mono : look.fonts.small;
  const float right = row.high.x - look.px(10), left = right - text_size(font, figure).x - 1;
  put_text(context.ui, look.fonts.regular, theme.text,
           Rect{{row.low.x + look.px(32), row.low.y}, {left - look.px(8), row.high.y}}, gate.name);
  put_text(context.ui, font, failed ? theme.error : theme.text2, Rect{{left, row.low.y}, {right, row.high.y}}, figure,
           Align::Right);
  if (pressed.hovered)
    tooltip(
        context.ui, row,
        gate.name + (failed     ? ": failed"
                     : measured ? ": passed"
                                : ": not checked"),
        gate.sentence + "\n" + gate.meaning + (gate.worst.empty() ? "" : "\n" + gate.worst + ". Click to select it."));
  if (pressed.clicked && !gate.worst.empty()) go_to_worst(context, gate);
}

// Returns text about failed gates for the section's heading: ", 3 failed", or "" if none failed.
std::string failures(Context& context, const std::shared_ptr<const Result>& result) {
  const auto& gates = facts_of(context, result)->gates;
  const auto failed = std::count_if(gates.begin(), gates.end(),
                                    [](const QualityGate& gate) { return gate.state == GateState::Failed; });
  return failed ? ", " + std::to_string(failed) + " failed" : "";
}

void draw_line(Context& context, Column& column, const std::string& name, const std::string& value, bool mono,
               const std::string& whole = "") {
  const Look& look = context.ui->look;
  const Rect row = column.row(22);
  const float middle = row.low.x + look.px(120), right = row.high.x - look.px(10);
  put_text(context.ui, look.fonts.regular, look.theme.text2,
           Rect{{row.low.x + look.px(10), row.low.y}, {middle - look.px(6), row.high.y}}, name);
  put_text(context.ui, mono ? look.fonts.mono : look.fonts.regular, look.theme.text,
           Rect{{middle, row.low.y}, {right, row.high.y}}, value, Align::Right);
  if (whole.empty() || whole == value) return;
  const Pressed pressed = press_area(context.ui, name, row);
  if (pressed.hovered) tooltip(context.ui, row, name, whole + "\nClick to copy it.");
  if (pressed.clicked) context.host->set_clipboard(whole);
}

void draw_title(Ui& ui, Column& column, const std::string& words) {
  const Rect row = column.row(24);
  put_text(ui, ui.look.fonts.small, ui.look.theme.text2,
           Rect{{row.low.x + ui.look.px(10), row.low.y + ui.look.px(4)}, row.high}, words);
}

}  // namespace

void draw_gates(Context& context, Column& column) {
  const auto result = chosen_result(context);
  if (column.begin_section("Quality gates", result ? method_name(result->method) + failures(context, result) : "")) {
    const Look& look = context.ui->look;
    column.space(4);
    if (!result) {
      const Rect row = column.row(26);
      put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{row.low.x + look.px(10), row.low.y}, row.high},
               "No result yet");
    } else {
      // Failed gates come first.
      for (const GateState state : {GateState::Failed, GateState::Passed, GateState::NotMeasured})
        for (const QualityGate& gate : facts_of(context, result)->gates)
          if (gate.state == state) draw_gate(context, column, gate);
    }
    column.space(4);
  }
  column.end_section();
}

void draw_provenance(Context& context, Column& column) {
  const auto result = chosen_result(context);
  if (column.begin_section("Provenance", "", false) && result) {
    const auto facts = facts_of(context, result);
    column.space(4);
    draw_line(context, column, "Result", result->name, false);
    draw_line(context, column, "Method", method_name(result->method), false);
    if (!facts->version.empty()) draw_line(context, column, "Limber", facts->version, true);
    for (const auto& line : facts->settings) draw_line(context, column, line.name, line.value, false);
    if (!facts->inputs.empty()) draw_title(context.ui, column, "Inputs, SHA-256");
    for (const auto& line : facts->inputs) draw_line(context, column, line.name, line.value, true, line.whole);
    if (!facts->stages.empty()) draw_title(context.ui, column, "Time");
    for (const auto& line : facts->stages) draw_line(context, column, line.name, line.value, true);
    if (facts->peak_memory_mb) {
      char text[32];
      std::snprintf(text, sizeof text, "%.0f MB", *facts->peak_memory_mb);
      draw_line(context, column, "Memory", text, true);
    }
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
