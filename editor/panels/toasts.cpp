// SPDX-License-Identifier: AGPL-3.0-or-later
// Short messages at the bottom right of the views: info 4 s, warnings 8 s, errors stay; pointing at one holds it.
#include "editor/icons.h"
#include "editor/panels/panels.h"

namespace limber::editor {

namespace {

constexpr std::size_t kMost = 3;

double life_of(Severity severity) { return severity == Severity::Error ? 1e300 : severity == Severity::Warning ? 8 : 4; }

struct Face {
  const char* icon;
  Colour colour;
};
Face face_of(const Theme& theme, Severity severity) {
  switch (severity) {
    case Severity::Info: return {icon::kInfo, theme.accent_text};
    case Severity::Ok: return {icon::kOk, theme.ok};
    case Severity::Warning: return {icon::kWarning, theme.warn};
    case Severity::Error: break;
  }
  return {icon::kError, theme.error};
}

// True when it was closed.
bool draw_toast(Editor& editor, const Toast& toast, const Rect& rect, int index, bool& held) {
  const Look& look = editor.look;
  begin_region(editor, Region::Toast, "toast " + std::to_string(index), rect, 0);
  const Face face = face_of(look.theme, toast.severity);
  fill(rect, look.theme.panel, look.px(6));
  outline(rect, look.theme.line2, look.px(6), look.line());
  ImGui::GetWindowDrawList()->AddRectFilled(im(rect.low), {rect.low.x + look.px(3), rect.high.y}, face.colour, look.px(6), ImDrawFlags_RoundCornersLeft);
  put_icon(look.fonts.regular, face.colour, Rect{{rect.low.x + look.px(14), rect.low.y}, {rect.low.x + look.px(34), rect.high.y}}, face.icon);
  const float left = rect.low.x + look.px(42), right = rect.high.x - look.px(34), middle = rect.centre().y;
  const Operator* action = toast.action.empty() ? nullptr : find_operator(editor, toast.action);
  const float action_width = action ? text_size(look.fonts.regular, action->label).x + look.px(24) : 0, words_right = right - action_width;
  const std::string line = toast.times > 1 ? toast.line + " (" + std::to_string(toast.times) + " times)" : toast.line;
  if (toast.detail.empty()) put_text(editor, look.fonts.regular, look.theme.text, Rect{{left, rect.low.y}, {words_right, rect.high.y}}, line);
  else {
    put_text(editor, look.fonts.regular, look.theme.text, Rect{{left, middle - look.px(18)}, {words_right, middle}}, line);
    put_text(editor, look.fonts.small, look.theme.text2, Rect{{left, middle}, {words_right, middle + look.px(16)}}, toast.detail);
  }
  if (action) {
    const Rect link{{right - action_width + look.px(8), middle - look.px(12)}, {right, middle + look.px(12)}};
    const Pressed pressed = press_area(editor, action->label, link);
    put_text(editor, look.fonts.regular, look.theme.accent_text, link, action->label, Align::Centre);
    if (pressed.hovered) operator_tooltip(editor, *action, link);
    if (pressed.clicked) run(editor, *action);
  }
  held = rect.contains(editor.input.pointer);
  const Rect close{{rect.high.x - look.px(30), middle - look.px(12)}, {rect.high.x - look.px(6), middle + look.px(12)}};
  const bool closed = button(editor, "Close message", close, {icon::kClose, "", ButtonStyle::Flat});
  end_region(editor);
  return closed;
}

}  // namespace

void draw_toasts(Editor& editor) {
  auto& toasts = editor.messages.toasts;
  const Look& look = editor.look;
  for (Toast& toast : toasts)
    if (toast.since < 0) toast.since = editor.now;
  std::erase_if(toasts, [&](const Toast& toast) { return editor.now - toast.since > life_of(toast.severity); });

  const Rect& views = editor.layout.views;
  float bottom = views.high.y - look.px(12);
  const float width = std::min(look.px(332), views.width() - look.px(24));
  const std::size_t shown = std::min(toasts.size(), kMost);
  std::size_t closed = toasts.size();
  for (std::size_t i = 0; i < shown; ++i) {
    Toast& toast = toasts[toasts.size() - 1 - i];
    const Rect rect{{views.high.x - look.px(12) - width, bottom - look.px(52)}, {views.high.x - look.px(12), bottom}};
    bool held = false;
    if (draw_toast(editor, toast, rect, static_cast<int>(i), held)) closed = toasts.size() - 1 - i;
    if (held) toast.since = editor.now;
    if (life_of(toast.severity) < 1e9) editor.wake_at(toast.since + life_of(toast.severity) + 0.01);
    bottom = rect.low.y - look.px(8);
  }
  if (closed < toasts.size()) toasts.erase(toasts.begin() + static_cast<std::ptrdiff_t>(closed));
}

}  // namespace limber::editor
