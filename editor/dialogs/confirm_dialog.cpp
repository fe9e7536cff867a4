// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/confirm_dialog.h"

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/dialogs/dialog.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 480;

class QuestionDialog final : public Dialog {
 public:
  explicit QuestionDialog(Question question) : question_(std::move(question)) {}

  void draw(Context& context) override {
    const Look& look = context.ui->look;
    ImFont* font = look.fonts.regular;
    const float text_width = look.px(kWidth - 36 - 32);
    float height = 0;
    for (const std::string& line : question_.lines)
      height += height_of_wrapped(font, line, text_width) / look.scale + 8;
    const Rect rect = begin_dialog(context, question_.title, kWidth, 36 + 18 + height + 12 + 28 + 18);
    put_icon(look.fonts.icons, look.theme.accent_text, Rect{rect.low, rect.low + look.px(20)}, question_.icon);
    float y = rect.low.y;
    for (const std::string& line : question_.lines) {
      y += put_wrapped(context.ui, font, look.theme.text, {rect.low.x + look.px(32), y}, text_width, line) + look.px(8);
    }
    draw_answers(context, rect);
    end_dialog(context);
  }

 private:
  void draw_answers(Context& context, const Rect& rect) {
    const Look& look = context.ui->look;
    const Answer* chosen = nullptr;
    float right = rect.high.x;
    for (auto answer = question_.answers.rbegin(); answer != question_.answers.rend(); ++answer) {
      const ButtonLook face{"", answer->label, answer->primary ? ButtonStyle::Primary : ButtonStyle::Plain};
      const float width = std::max(width_of_button(context.ui, face) + look.px(8), look.px(80));
      if (button(context.ui, answer->label, {{right - width, rect.high.y - look.px(28)}, {right, rect.high.y}}, face))
        chosen = &*answer;
      if (answer->primary &&
          (ImGui::IsKeyPressed(static_cast<int>(Key::Return), false) ||
           ImGui::IsKeyPressed(static_cast<int>(Key::NumEnter), false)) &&
          shown_ && !had_error_)
        chosen = &*answer;
      right -= width + look.px(8);
    }
    shown_ = true;
    had_error_ = !context.messages->errors.empty();
    if (!chosen) return;
    const auto act = chosen->act;
    context.dialogs->close();
    context.ui->touch();
    if (act) attempt(context, question_.title, act);
  }

  Question question_;
  bool shown_ = false;      // false in the dialog's first frame, in which Return may be the key that opened the dialog
  bool had_error_ = false;  // true: an error message covered the dialog in the last frame, so keys go to the message
};

}  // namespace

void ask(Context& context, Question question) {
  context.dialogs->open(std::make_unique<QuestionDialog>(std::move(question)));
  context.ui->touch();
}

}  // namespace limber::editor
