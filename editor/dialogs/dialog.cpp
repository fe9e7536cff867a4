// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/dialog.h"

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/screen.h"
#include "editor/ui/icons.h"

namespace limber::editor {

Rect begin_dialog(Context& context, const std::string& title, float width, float height,
                  const std::function<void()>& close) {
  const Look& look = context.ui->look;
  const glm::vec2 window = context.screen->layout.window.size();
  const glm::vec2 size = glm::min(glm::vec2(look.px(width), look.px(height)), window - look.px(16));
  const glm::vec2 corner = glm::round((window - size) * 0.5f);
  const Rect rect{corner, corner + size};

  // The region "dim" darkens the whole window. It also takes presses of mouse buttons outside the dialog, so that they
  // do nothing.
  begin_region(context.ui, Region::Dialog, "dim", context.screen->layout.window, with_alpha(0xFF000000, 0.45f));
  end_region(context.ui);
  begin_region(context.ui, Region::Dialog, "dialog", rect, 0);
  fill(rect, look.theme.panel, look.px(8));
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(36)}};
  ImGui::GetWindowDrawList()->AddRectFilled(im(head.low), im(head.high), look.theme.head, look.px(8),
                                            ImDrawFlags_RoundCornersTop);
  outline(rect, look.theme.line2, look.px(8), look.line());
  put_text(context.ui, look.fonts.semibold, look.theme.text,
           Rect{{head.low.x + look.px(14), head.low.y}, {head.high.x - look.px(40), head.high.y}}, title);
  const Rect cross{{head.high.x - look.px(32), head.low.y + look.px(6)},
                   {head.high.x - look.px(8), head.low.y + look.px(30)}};
  if (button(context.ui, "Close", cross, {icon::kClose, "", ButtonStyle::Flat}))
    close ? close() : context.dialogs->close();
  return {{rect.low.x + look.px(18), head.high.y + look.px(18)}, rect.high - look.px(18)};
}

void end_dialog(Context& context) { end_region(context.ui); }

}  // namespace limber::editor
