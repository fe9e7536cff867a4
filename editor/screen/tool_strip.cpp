// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the strip at the left edge: the tools, one of which is active, and buttons that turn overlays on and off.
#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/measure/measure_tool.h"
#include "editor/skin/painting.h"
#include "editor/ui/icons.h"

namespace limber::editor {

void draw_tool_strip(Context& context) {
  const Rect& rect = context.screen->layout.tool_strip;
  if (rect.empty()) return;
  const Look& look = context.ui->look;
  begin_region(context.ui, Region::ToolStrip, "strip", rect, look.theme.panel);
  fill({{rect.high.x - look.line(), rect.low.y}, rect.high}, look.theme.void_);
  float y = rect.low.y + look.px(4);
  std::vector<std::string> tools = {"tool.select",   "tool.cross_hair", "-",
                                    "view.clip_box", "view.clip_plane", "measure.menu"};
  if (context.workspace() == Workspace::Pose)
    tools = {"tool.select", "tool.cross_hair", "-", "tool.move",     "tool.rotate",     "tool.reach",
             "-",           "pose.breakdown",  "-", "view.clip_box", "view.clip_plane", "measure.menu"};
  if (context.workspace() == Workspace::Skin)
    tools = with_brushes({"*", "-", "skin.gradient", "skin.region_box", "skin.seam_brush", "labels.brush",
                          "skin.pick_bone", "-", "view.clip_box", "view.clip_plane", "measure.menu"});
  if (context.workspace() == Workspace::Rig)
    tools = {"tool.select", "tool.cross_hair", "-", "tool.move",     "tool.rotate",     "tool.scale",  "-",
             "rig.add",     "tool.extrude",    "-", "view.clip_box", "view.clip_plane", "measure.menu"};
  // Compute the height of a button. In a low window the buttons are lower, so that all of them fit.
  const auto lines = static_cast<float>(std::count(tools.begin(), tools.end(), "-"));
  const float rows = static_cast<float>(tools.size()) - lines;
  const float room = std::floor((rect.height() - look.px(8) - lines * look.px(11)) / rows) - look.px(1);
  const float height = std::clamp(room, look.px(18), look.px(34));
  for (const std::string& id : tools) {
    if (id == "-") {
      fill({{rect.low.x + look.px(8), y + look.px(5)}, {rect.high.x - look.px(9), y + look.px(5) + look.line()}},
           look.theme.line2);
      y += look.px(11);
      continue;
    }
    const Operator* op = find_operator(context.operators, id);
    const Rect place{{rect.low.x + look.px(4), y}, {rect.low.x + look.px(40), y + height}};
    const Pressed pressed = press_area(context.ui, id, place, disabled_reason(context, *op).empty());
    // While the pointer measures, the measure tool is the active one. Clipping stays on beside it.
    const bool on =
        is_measuring(context) && !id.starts_with("view.") ? id == "measure.menu" : op->checked && op->checked(context);
    if (on) fill(place, look.theme.accent, look.px(5));
    else if (pressed.hovered) fill(place, look.theme.hover, look.px(5));
    const Colour colour = on                                      ? look.theme.on_accent
                          : disabled_reason(context, *op).empty() ? look.theme.text
                                                                  : look.theme.text3;
    put_icon(look.fonts.icons, colour, place, op->icon);
    if (pressed.hovered) operator_tooltip(context, *op, place);
    if (pressed.clicked) run(context, *op);
    y = place.high.y + look.px(1);
  }
  end_region(context.ui);
}

}  // namespace limber::editor
