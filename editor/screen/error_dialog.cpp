// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the dialog for an error that an action of the user caused. The dialog says what happened, where, and what to
// do, and stays until the user closes it. The user can copy its text with details for a bug report.
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/platform_window.h"
#include "editor/context/screen.h"
#include "editor/dialogs/dialog.h"
#include "editor/screen/help_dialog.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 480, kButton = 28;
constexpr const char kUnharmed[] = "Nothing was changed in the project.";

// Returns the text for a bug report: the chain of errors from the outermost one to the cause, and the system facts
// (program version, graphics driver, monitor scale).
std::string details_of(const Context& context, const ErrorMessage& message) {
  std::string text = message.line;
  for (auto at = text.find(": "); at != std::string::npos; at = text.find(": ", at + 3)) text.replace(at, 2, ":\n");
  if (!message.during.empty()) text = "During: " + message.during + "\n" + text;
  return text + "\n" + system_facts(context);
}

struct Part {
  ImFont* font;
  Colour colour;
  std::string text;
};

// Draws the line at the top of the message, which follows the round corners of its dialog.
void draw_top_line(const Look& look, const Rect& dialog) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  canvas.PushClipRect(im(dialog.low), {dialog.high.x, dialog.low.y + look.px(3)}, true);
  fill(dialog, look.theme.error, look.px(8));
  canvas.PopClipRect();
}

}  // namespace

void draw_error_message(Context& context) {
  if (context.messages->errors.empty()) {
    context.messages->details_open = false;
    return;
  }
  const ErrorMessage message = context.messages->errors.front();
  const Look& look = context.ui->look;
  const std::string title =
      message.times > 1 ? message.what + " (" + std::to_string(message.times) + " times)" : message.what;
  const float width =
      std::min(look.px(kWidth), context.screen->layout.window.width() - look.px(16)) - look.px(18 + 30 + 18);
  std::vector<Part> parts{{look.fonts.semibold, look.theme.text, title},
                          {look.fonts.regular, look.theme.text2, message.where},
                          {look.fonts.regular, look.theme.text, message.what_to_do},
                          {look.fonts.small, look.theme.text2, kUnharmed}};
  std::erase_if(parts, [](const Part& part) { return part.text.empty(); });
  float words = 0;
  for (const Part& part : parts) words += height_of_wrapped(part.font, part.text, width, 6) + look.px(8);
  const auto close_first = [&context] { context.messages->errors.erase(context.messages->errors.begin()); };
  const std::string details = context.messages->details_open ? details_of(context, message) : "";
  const float plate = context.messages->details_open
                          ? height_of_wrapped(look.fonts.small_mono, details, width - look.px(16), 12) + look.px(12 + 8)
                          : 0;
  const Rect rect =
      begin_dialog(context, "Message", kWidth, (words + plate) / look.scale + 36 + 18 + 10 + kButton + 18, close_first);

  const Rect whole{{rect.low.x - look.px(18), rect.low.y - look.px(54)}, rect.high + look.px(18)};
  draw_top_line(look, whole);
  put_icon(look.fonts.icons, look.theme.error, Rect{rect.low, rect.low + look.px(20)}, icon::kError);
  const float left = rect.low.x + look.px(30);
  float y = rect.low.y;
  for (const Part& part : parts)
    y += put_wrapped(context.ui, part.font, part.colour, {left, y}, width, part.text, 6) + look.px(8);
  if (context.messages->details_open) {
    fill({{left, y}, {rect.high.x, y + plate - look.px(8)}}, look.theme.field, look.px(4));
    put_wrapped(context.ui, look.fonts.small_mono, look.theme.text2, {left + look.px(8), y + look.px(6)},
                width - look.px(16), details, 12);
  }

  const float low = rect.high.y - look.px(kButton);
  const ButtonLook fold{context.messages->details_open ? icon::kOpened : icon::kClosed, "Details", ButtonStyle::Flat};
  const Rect place{{left - look.px(8), low}, {left - look.px(8) + width_of_button(context.ui, fold), rect.high.y}};
  if (button(context.ui, "Details", place, fold)) {
    context.messages->details_open = !context.messages->details_open;
    context.ui->touch();
  }
  if (ImGui::IsItemHovered())
    tooltip(context.ui, place, "Details", "Show the full message and the system facts, for a bug report.");
  const Rect close{{rect.high.x - look.px(80), low}, rect.high};
  const ButtonLook copy_face{icon::kCopy, "Copy"};
  const Rect copy{{close.low.x - look.px(8) - width_of_button(context.ui, copy_face), low},
                  {close.low.x - look.px(8), rect.high.y}};
  if (button(context.ui, "Copy message", copy, copy_face)) context.host->set_clipboard(details_of(context, message));
  if (ImGui::IsItemHovered()) tooltip(context.ui, copy, "Copy", "Copy the message and its details to the clipboard.");
  if (button(context.ui, "Close", close, {"", "Close", ButtonStyle::Primary})) close_first();
  end_dialog(context);
}

}  // namespace limber::editor
