// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/form_dialog.h"

#include <algorithm>
#include <cstdio>

#include "core/base/error.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/dialogs/dialog.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 480, kRow = 34, kLabel = 130, kProblem = 18, kPicture = 240;
constexpr std::size_t kMostBeside = 4;
constexpr int kMostLines = 5;  // the text that tells what the form's action will do is cut off after this many lines

bool draw_choice(Ui& ui, FormField& field, const Rect& rect) {
  const Look& look = ui.look;
  float widest = 0;
  for (const std::string& choice : field.choices) widest = std::max(widest, width_of_button(ui, {"", choice}));
  const float width = std::round(rect.width() / static_cast<float>(field.choices.size()));
  if (field.choices.size() > kMostBeside || widest > width) {
    const bool changed = choice_field(ui, rect, field.choices, field.chosen);
    if (ImGui::IsMouseHoveringRect(im(rect.low), im(rect.high)) &&
        !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId))
      tooltip(ui, rect, field.label, field.description);
    return changed;
  }
  const int before = field.chosen;
  for (int i = 0; i < std::ssize(field.choices); ++i) {
    const Rect place{{rect.low.x + width * static_cast<float>(i), rect.low.y},
                     {rect.low.x + width * static_cast<float>(i + 1) - look.px(1), rect.high.y}};
    if (button(ui, field.choices[i], place,
               {"", field.choices[i], i == field.chosen ? ButtonStyle::Chosen : ButtonStyle::Plain}))
      field.chosen = i;
    if (ImGui::IsItemHovered()) tooltip(ui, place, field.label, field.description);
  }
  return field.chosen != before;
}

class Form final : public Dialog {
 public:
  explicit Form(FormRequest request) : request_(std::move(request)) {}

  void draw(Context& context) override;
  bool key(Context&, const Chord& chord) override {
    if (chord.key != Key::Return && chord.key != Key::NumEnter) return false;
    return accept_ = true;
  }

 private:
  FormRequest request_;
  bool accept_ = false;
  bool focused_ = false;               // true once the first text or number field has got the keyboard
  std::string words_;                  // text below the fields that tells what the action will do
  std::vector<std::string> problems_;  // for each field, the text that tells what is wrong with its number; "": nothing
};

// Returns a text that tells the user what is wrong with the number in a field. Returns "" if the number is in its
// range, or if the field has no number.
std::string problem_of(const FormField& field) {
  if (field.kind != FormField::Kind::Number || (field.value >= field.low && field.value <= field.high)) return "";
  char low[48], high[48];
  std::snprintf(low, sizeof low, field.format, field.low);
  std::snprintf(high, sizeof high, field.format, field.high);
  return std::string("Enter a number from ") + low + " to " + high +
         (*field.unit ? std::string(" ") + field.unit : "") + ".";
}

// Returns the height of a field's row in pixels at scale 1. The line below it, which tells what is wrong with the
// field's number, is not included.
float height_of(const Look& look, const FormField& field) {
  if (field.kind != FormField::Kind::Fact) return kRow;
  return std::max(
      kRow, 16 + height_of_wrapped(look.fonts.regular, field.text, look.px(kWidth - 36 - kLabel - 8)) / look.scale);
}

void Form::draw(Context& context) {
  const Look& look = context.ui->look;
  const float description =
      height_of_wrapped(look.fonts.regular, request_.description, look.px(kWidth - 36), 2) > look.px(24) ? 44 : 28;
  // Updates the lines about wrong numbers only while the left mouse button is up. They change the dialog's layout, and
  // nothing may move under the pointer during a press.
  if (!context.ui->input.down(MouseButton::Left) || problems_.size() != request_.fields.size()) {
    problems_.clear();
    for (const FormField& field : request_.fields) problems_.push_back(problem_of(field));
  }
  float fields = 0;
  for (std::size_t i = 0; i < problems_.size(); ++i)
    fields += height_of(look, request_.fields[i]) + (problems_[i].empty() ? 0 : kProblem);
  const float said = std::max(
      52.0f, 20 + height_of_wrapped(look.fonts.small, words_, look.px(kWidth - 36 - 24), kMostLines) / look.scale);
  Rect rect = begin_dialog(context, request_.title, kWidth + (request_.picture ? kPicture + 18 : 0),
                           36 + 18 + description + fields + said + 28 + 18);
  if (request_.picture) {
    const float left = rect.high.x - look.px(kPicture);
    request_.picture(context, {{left, rect.low.y}, rect.high}, request_.fields);
    rect.high.x = left - look.px(18);
  }
  put_wrapped(context.ui, look.fonts.regular, look.theme.text2, rect.low, rect.width(), request_.description, 2);
  float y = rect.low.y + look.px(description);
  for (std::size_t i = 0; i < request_.fields.size(); ++i) {
    FormField& field = request_.fields[i];
    const bool typed_into = field.kind == FormField::Kind::Text || field.kind == FormField::Kind::Number;
    const float end = y + look.px(height_of(look, field));
    draw_field(context, field, {{rect.low.x, y}, {rect.high.x, end}}, look.px(kLabel),
               typed_into && !std::exchange(focused_, true), OutOfRange::Stays);
    y = end;
    if (const std::string& wrong = problems_[i]; !wrong.empty()) {
      put_text(context.ui, look.fonts.small, look.theme.warn,
               Rect{{rect.low.x + look.px(kLabel + 8), y - look.px(3)}, {rect.high.x, y + look.px(kProblem - 3)}},
               wrong);
      y += look.px(kProblem);
    }
  }

  std::string outcome, problem;
  bool ready = std::all_of(request_.fields.begin(), request_.fields.end(),
                           [](const FormField& field) { return problem_of(field).empty(); });
  try {
    if (request_.outcome && ready) outcome = request_.outcome(context, request_.fields);
  } catch (const Error& error) {
    problem = error.what();
    ready = false;
  } catch (const NotYet& waiting) {
    outcome = waiting.words;
    ready = false;
  }
  const std::string& words = problem.empty() ? outcome : problem;
  if (words != words_ && !context.ui->input.down(MouseButton::Left)) {
    words_ = words;
    context.ui->touch();
  }
  float x = rect.low.x;
  if (!problem.empty()) {
    put_icon(look.fonts.regular, look.theme.warn, Rect{{x, y + look.px(8)}, {x + look.px(18), y + look.px(26)}},
             icon::kWarning);
    x += look.px(24);
  }
  put_wrapped(context.ui, look.fonts.small, problem.empty() ? look.theme.text2 : look.theme.warn, {x, y + look.px(10)},
              rect.high.x - x, words, kMostLines);

  const ButtonLook action{"", request_.action, ButtonStyle::Primary, ready};
  const float width = std::max(look.px(96), width_of_button(context.ui, action)), low = rect.high.y - look.px(28),
              cancel = look.px(80);
  const Rect primary{{rect.high.x - width, low}, rect.high};
  const bool pressed = button(context.ui, request_.action, primary, action);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    tooltip(context.ui, primary, request_.action, ready ? request_.description : problem,
            Chord{Chord::Kind::Key, {}, Key::Return});
  if (button(context.ui, "Cancel",
             {{primary.low.x - look.px(8) - cancel, low}, {primary.low.x - look.px(8), rect.high.y}}, {"", "Cancel"}))
    context.dialogs->close();
  end_dialog(context);

  if (!(pressed || std::exchange(accept_, false)) || !ready) return;
  context.dialogs->close();
  attempt(context, request_.title, [this](Context& c) { act_and_allow_redo(c, request_.fields, request_.act); });
}

}  // namespace

bool draw_field(Context& context, FormField& field, const Rect& row, float label_width, bool focus,
                OutOfRange numbers) {
  const Look& look = context.ui->look;
  const PathScope path(context.ui, field.label);
  put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{row.low, {row.low.x + label_width, row.high.y}},
           field.label);
  const Rect rect{{row.low.x + label_width + look.px(8), row.low.y + look.px(4)},
                  {row.high.x, row.high.y - look.px(4)}};
  if (field.kind == FormField::Kind::Choice) return draw_choice(context.ui, field, rect);
  if (field.kind == FormField::Kind::Text) return text_field(context.ui, "text", rect, field.text, "", focus);
  if (field.kind == FormField::Kind::Fact) {
    const int lines = std::max(1, static_cast<int>((row.height() - look.px(12)) / look.fonts.regular->FontSize));
    put_wrapped(context.ui, look.fonts.regular, look.theme.text, {rect.low.x, row.low.y + look.px(8)}, rect.width(),
                field.text, lines);
    return false;
  }
  bool committed = false;
  if (numbers == OutOfRange::Clamped)
    number_field(context.ui, "value", rect, field.value, field.low, field.high, field.format, field.unit, false,
                 committed);
  else
    committed = judged_number_field(context.ui, "value", rect, field.value, field.low, field.high, field.format,
                                    field.unit, focus);
  if (ImGui::IsItemHovered())
    tooltip(context.ui, rect, field.label, field.description + "\nDrag to change the number, or click and type.");
  return committed;
}

FormField number_of(std::string label, std::string description, double value, double low, double high,
                    const char* format, const char* unit) {
  FormField field{std::move(label), std::move(description)};
  field.value = value;
  field.low = low;
  field.high = high;
  field.format = format;
  field.unit = unit;
  return field;
}

FormField choice_of(std::string label, std::string description, std::vector<std::string> choices, int chosen) {
  FormField field{std::move(label), std::move(description), FormField::Kind::Choice};
  field.choices = std::move(choices);
  field.chosen = chosen;
  return field;
}

FormField text_of(std::string label, std::string description, std::string text) {
  FormField field{std::move(label), std::move(description), FormField::Kind::Text};
  field.text = std::move(text);
  return field;
}

FormField fact_of(std::string label, std::string text) {
  FormField field{std::move(label), ""};
  field.kind = FormField::Kind::Fact;
  field.text = std::move(text);
  return field;
}

std::unique_ptr<Dialog> make_form(FormRequest request) { return std::make_unique<Form>(std::move(request)); }

}  // namespace limber::editor
