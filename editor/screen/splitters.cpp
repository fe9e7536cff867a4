// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the splitters between the regions of the window, and lets the user drag them. A splitter can be dragged by a
// strip 6 px wide; when the pointer rests on the strip, a coloured line appears. A double-click restores the default
// size.
#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/context/window_state.h"

namespace limber::editor {

namespace {

constexpr float kGrip = 6;            // width of the strip by which a splitter can be dragged, px at scale 1
constexpr double kShownAfter = 0.15;  // time that the pointer rests on the strip before the line is shown, s

const char* name_of(SplitterId id) {
  constexpr const char* kNames[] = {"sidebar", "bottom", "split-x", "split-y", "four-x", "four-y"};
  return kNames[static_cast<int>(id)];
}

}  // namespace

void draw_splitters(Context& context) {
  const Look& look = context.ui->look;
  for (const Splitter& splitter : context.screen->layout.splitters) {
    const float more =
        std::round((look.px(kGrip) - (splitter.vertical ? splitter.line.width() : splitter.line.height())) / 2);
    const glm::vec2 grow = splitter.vertical ? glm::vec2(more, 0) : glm::vec2(0, more);
    const Rect grip{splitter.line.low - grow, splitter.line.high + grow};
    begin_region(context.ui, Region::Views, std::string("splitter ") + name_of(splitter.id), grip, 0);
    const Pressed pressed = press_area(context.ui, "grip", grip);
    if (pressed.hovered || pressed.held) context.window->cursor = splitter.vertical ? Cursor::ResizeX : Cursor::ResizeY;
    if (pressed.hovered && context.window->hovered_splitter != &splitter - context.screen->layout.splitters.data()) {
      context.window->hovered_splitter = static_cast<int>(&splitter - context.screen->layout.splitters.data());
      context.window->splitter_since = context.ui->now;
    }
    if (pressed.held || (pressed.hovered && context.ui->now - context.window->splitter_since >= kShownAfter)) {
      const glm::vec2 middle = grip.centre(), half = glm::vec2(look.line());
      fill(splitter.vertical ? Rect{{middle.x - half.x, grip.low.y}, {middle.x + half.x, grip.high.y}}
                             : Rect{{grip.low.x, middle.y - half.y}, {grip.high.x, middle.y + half.y}},
           look.theme.accent);
    }
    if (pressed.hovered && !pressed.held && context.ui->now < context.window->splitter_since + kShownAfter)
      context.ui->wake_at(context.window->splitter_since + kShownAfter);
    if (pressed.double_clicked)
      context.screen->arrangement() = restored(context.screen->arrangement(), splitter.id, context.workspace());
    else if (pressed.held && !pressed.activated && ImGui::GetIO().MouseClickedLastCount[ImGuiMouseButton_Left] < 2)
      context.screen->arrangement() = dragged(context.screen->arrangement(), splitter.id, context.ui->input.pointer,
                                              context.screen->layout, look.scale);
    end_region(context.ui);
  }
}

}  // namespace limber::editor
