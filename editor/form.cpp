// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/form.h"

#include "core/base/error.h"
#include "editor/adjust.h"
#include "editor/dialog.h"
#include "editor/fields.h"
#include "editor/icons.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 480, kRow = 34, kLabel = 130;
constexpr std::size_t kMostBeside = 4;

bool draw_choice(Editor& editor, FormField& field, const Rect& rect) {
  const Look& look = editor.look;
  float widest = 0;
  for (const std::string& choice : field.choices) widest = std::max(widest, width_of_button(editor, {"", choice}));
  const float width = std::round(rect.width() / static_cast<float>(field.choices.size()));
  if (field.choices.size() > kMostBeside || widest > width) {
    const bool changed = choice_field(editor, rect, field.choices, field.chosen);
    if (ImGui::IsMouseHoveringRect(im(rect.low), im(rect.high)) && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId)) tooltip(editor, rect, field.label, field.sentence);
    return changed;
  }
  const int before = field.chosen;
  for (int i = 0; i < std::ssize(field.choices); ++i) {
    const Rect place{{rect.low.x + width * static_cast<float>(i), rect.low.y}, {rect.low.x + width * static_cast<float>(i + 1) - look.px(1), rect.high.y}};
    if (button(editor, field.choices[i], place, {"", field.choices[i], i == field.chosen ? ButtonStyle::Chosen : ButtonStyle::Plain})) field.chosen = i;
    if (ImGui::IsItemHovered()) tooltip(editor, place, field.label, field.sentence);
  }
  return field.chosen != before;
}

class Form final : public Dialog {
 public:
  explicit Form(FormRequest request) : request_(std::move(request)) {}

  void draw(Editor& editor) override;
  bool key(Editor&, const Chord& chord) override {
    if (chord.key != Key::Return && chord.key != Key::NumEnter) return false;
    return accept_ = true;
  }

 private:
  FormRequest request_;
  bool accept_ = false;
  bool focused_ = false;  // its text field has been given the keyboard
};

void Form::draw(Editor& editor) {
  const Look& look = editor.look;
  const float sentence = height_of_wrapped(look.fonts.regular, request_.sentence, look.px(kWidth - 36), 2) > look.px(24) ? 44 : 28;
  const float height = 36 + 18 + sentence + kRow * static_cast<float>(request_.fields.size()) + 52 + 28 + 18;
  const Rect rect = begin_dialog(editor, request_.title, kWidth, height);
  put_wrapped(editor, look.fonts.regular, look.theme.text2, rect.low, rect.width(), request_.sentence, 2);
  float y = rect.low.y + look.px(sentence);
  for (FormField& field : request_.fields) {
    draw_field(editor, field, {{rect.low.x, y}, {rect.high.x, y + look.px(kRow)}}, look.px(kLabel), field.kind == FormField::Kind::Text && !std::exchange(focused_, true));
    y += look.px(kRow);
  }

  std::string outcome, problem;
  bool ready = true;
  try {
    if (request_.outcome) outcome = request_.outcome(editor, request_.fields);
  } catch (const Error& error) {
    problem = error.what();
    ready = false;
  } catch (const NotYet& waiting) {
    outcome = waiting.words;
    ready = false;
  }
  const std::string& words = problem.empty() ? outcome : problem;
  float x = rect.low.x;
  if (!problem.empty()) {
    put_icon(look.fonts.regular, look.theme.warn, Rect{{x, y + look.px(8)}, {x + look.px(18), y + look.px(26)}}, icon::kWarning);
    x += look.px(24);
  }
  put_wrapped(editor, look.fonts.small, problem.empty() ? look.theme.text2 : look.theme.warn, {x, y + look.px(10)}, rect.high.x - x, words, 3);

  const ButtonLook action{"", request_.action, ButtonStyle::Primary, ready};
  const float width = std::max(look.px(96), width_of_button(editor, action)), low = rect.high.y - look.px(28), cancel = look.px(80);
  const Rect primary{{rect.high.x - width, low}, rect.high};
  const bool pressed = button(editor, request_.action, primary, action);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) tooltip(editor, primary, request_.action, ready ? request_.sentence : problem, Chord{Chord::Kind::Key, {}, Key::Return});
  if (button(editor, "Cancel", {{primary.low.x - look.px(8) - cancel, low}, {primary.low.x - look.px(8), rect.high.y}}, {"", "Cancel"})) editor.close_dialog();
  end_dialog(editor);

  if (!(pressed || std::exchange(accept_, false)) || !ready) return;
  editor.close_dialog();
  attempt(editor, request_.title, [this](Editor& e) { act_adjustably(e, request_.fields, request_.act); });
}

}  // namespace

bool draw_field(Editor& editor, FormField& field, const Rect& row, float label_width, bool focus) {
  const Look& look = editor.look;
  const PathScope path(editor, field.label);
  put_text(editor, look.fonts.regular, look.theme.text2, Rect{row.low, {row.low.x + label_width, row.high.y}}, field.label);
  const Rect rect{{row.low.x + label_width + look.px(8), row.low.y + look.px(4)}, {row.high.x, row.high.y - look.px(4)}};
  if (field.kind == FormField::Kind::Choice) return draw_choice(editor, field, rect);
  if (field.kind == FormField::Kind::Text) return text_field(editor, "text", rect, field.text, "", focus);
  bool committed = false;
  number_field(editor, "value", rect, field.value, field.low, field.high, field.format, field.unit, false, committed);
  if (ImGui::IsItemHovered()) tooltip(editor, rect, field.label, field.sentence + "\nDrag it, or type after a double click.");
  return committed;
}

FormField number_of(std::string label, std::string sentence, double value, double low, double high, const char* format, const char* unit) {
  FormField field{std::move(label), std::move(sentence)};
  field.value = value;
  field.low = low;
  field.high = high;
  field.format = format;
  field.unit = unit;
  return field;
}

FormField choice_of(std::string label, std::string sentence, std::vector<std::string> choices, int chosen) {
  FormField field{std::move(label), std::move(sentence), FormField::Kind::Choice};
  field.choices = std::move(choices);
  field.chosen = chosen;
  return field;
}

FormField text_of(std::string label, std::string sentence, std::string text) {
  FormField field{std::move(label), std::move(sentence), FormField::Kind::Text};
  field.text = std::move(text);
  return field;
}

std::unique_ptr<Dialog> make_form(FormRequest request) { return std::make_unique<Form>(std::move(request)); }

}  // namespace limber::editor
