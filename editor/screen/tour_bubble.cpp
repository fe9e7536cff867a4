// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the bubble of the guided tour: a box with text beside the widget that the text explains, with an arrow to the
// widget.
#include "core/project/document.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/screen.h"
#include "editor/context/start_screen_state.h"
#include "editor/files/tour.h"
#include "editor/input/keymap.h"
#include "editor/ui/messages.h"

#include "editor/context/panels.h"
#include "editor/context/pointer_context.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 320, kPadding = 14, kArrow = 10;

// The position of the tour's bubble, which points to the widget that it explains. For a widget in the header, the
// bubble is below the widget; for a widget in the sidebar, it is left of the sidebar. So it covers no neighbouring
// button. For other widgets it is below, right or left, wherever there is room. If the widget is as large as a view,
// the bubble is inside the widget.
struct Place {
  Rect rect;
  glm::vec2 tip, base;  // ends of the arrow: its tip at the widget, its base at the bubble
};

Place place_of(const Context& context, const Rect& target, const glm::vec2& size) {
  const Rect window = context.screen->layout.window.grown(-context.ui->look.px(8));
  const float gap = context.ui->look.px(kArrow + 4);
  const auto within = [&](glm::vec2 corner) {
    return Rect{glm::round(glm::clamp(corner, window.low, window.high - size)),
                glm::round(glm::clamp(corner, window.low, window.high - size)) + size};
  };
  const glm::vec2 middle = target.centre();
  if (target.height() > 2 * size.y && target.width() > size.x) {
    // In a small view the bubble stays in the corner, so that the body and the middle of the view are free.
    const float above = target.height() > 4 * size.y ? context.ui->look.px(60) : context.ui->look.px(12);
    const Rect rect = within({target.low.x + context.ui->look.px(12), target.high.y - size.y - above});
    return {rect, rect.low + glm::vec2(size.x * 0.8f, -gap), rect.low + glm::vec2(size.x * 0.8f, 0)};
  }
  const Layout& layout = context.screen->layout;
  const bool in_header = layout.top_bar.contains(middle) || layout.tool_header.contains(middle);
  if (layout.sidebar.contains(middle)) {
    const Rect rect = within({layout.sidebar.low.x - gap - size.x, middle.y - context.ui->look.px(40)});
    return {rect,
            {std::min(target.low.x - context.ui->look.px(2), rect.high.x + context.ui->look.px(40)), middle.y},
            {rect.high.x, std::clamp(middle.y, rect.low.y + gap, rect.high.y - gap)}};
  }
  if (in_header || (target.high.y + gap + size.y < window.high.y && target.height() < context.ui->look.px(60) &&
                    target.high.x < window.high.x - context.ui->look.px(300))) {
    const Rect rect = within({middle.x - context.ui->look.px(60), target.high.y + gap});
    return {rect,
            {middle.x, target.high.y + context.ui->look.px(2)},
            {std::clamp(middle.x, rect.low.x + gap, rect.high.x - gap), rect.low.y}};
  }
  const bool right = target.high.x + gap + size.x < window.high.x;
  const Rect rect =
      within({right ? target.high.x + gap : target.low.x - gap - size.x, middle.y - context.ui->look.px(40)});
  const float y = std::clamp(middle.y, rect.low.y + gap, rect.high.y - gap);
  return {rect,
          {right ? target.high.x + context.ui->look.px(2) : target.low.x - context.ui->look.px(2), middle.y},
          {right ? rect.low.x : rect.high.x, y}};
}

}  // namespace

void draw_tour(Context& context) {
  if (!context.tour->shown || context.dialogs->shown || !context.messages->errors.empty() ||
      context.start_screen->shown || !context.document().volume)
    return;
  const Look& look = context.ui->look;
  const TourStep& step = tour_steps()[context.tour->step];
  ImFont* font = look.fonts.regular;
  const float wrap = look.px(kWidth - 2 * kPadding), padding = look.px(kPadding);
  const float words = height_of_wrapped(font, step.text, wrap);
  const glm::vec2 size{look.px(kWidth), look.px(14 + 24 + 8 + 26 + 14) + words};
  const Widget* target = context.ui->widgets.find(step.widget);
  const Place place = place_of(context, target ? target->rect : context.screen->layout.views, size);

  begin_region(context.ui, Region::Toast, "tour", place.rect, 0);
  register_widget(context.ui, "box", place.rect);
  ImDrawList& canvas = *ImGui::GetForegroundDrawList();
  fill(place.rect, look.theme.panel, look.px(6));
  outline(place.rect, look.theme.accent, look.px(6), 2 * look.line());
  if (target) {
    const glm::vec2 along = place.tip - place.base,
                    side = glm::length(along) > 0 ? glm::normalize(glm::vec2(-along.y, along.x)) * look.px(8)
                                                  : glm::vec2(0);
    canvas.AddTriangleFilled(im(place.tip), im(place.base + side), im(place.base - side), look.theme.accent);
  }
  const float left = place.rect.low.x + padding, right = place.rect.high.x - padding;
  float y = place.rect.low.y + look.px(12);
  put_text(context.ui, look.fonts.semibold, look.theme.text, Rect{{left, y}, {right, y + look.px(20)}}, step.title);
  if (const auto chord = context.keymap->chord_of(step.operator_id)) {
    const auto caps = key_caps(*chord);
    put_key_caps(context.ui, right - width_of_key_caps(context.ui, caps), y + look.px(10), caps);
  }
  y += look.px(26);
  put_wrapped(context.ui, font, look.theme.text2, {left, y}, wrap, step.text);

  const float low = place.rect.high.y - look.px(12 + 26), high = low + look.px(26);
  put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{left, low}, {left + look.px(80), high}},
           std::to_string(context.tour->step + 1) + " of " + std::to_string(tour_steps().size()));
  const float skip = look.px(80), end = look.px(76);
  if (button(context.ui, "Skip step", {{right - skip, low}, {right, high}}, {"", "Skip step"}))
    go_to_step(context, context.tour->step + 1);
  if (button(context.ui, "End tour", {{right - skip - look.px(8) - end, low}, {right - skip - look.px(8), high}},
             {"", "End tour", ButtonStyle::Flat}))
    end_tour(context);
  end_region(context.ui);
}

}  // namespace limber::editor
