// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/screen/preferences_dialog.h"

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/operator.h"
#include "editor/context/preferences.h"
#include "editor/context/preferences_state.h"
#include "editor/context/views.h"
#include "editor/dialogs/dialog.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

struct Page {
  const char* title;
  const char* icon;
};
constexpr Page kPages[] = {{"Interface", icon::kTheme}, {"Keymap", icon::kKeyboard},
                           {"View", icon::kCamera},     {"Undo and saving", icon::kHistory},
                           {"Jobs", icon::kJobs},       {"Folders", icon::kFolder}};

class PreferencesDialog final : public Dialog {
 public:
  PreferencesDialog(PreferencesPage page, const std::string& search) : page_(page), keys_(search) {}

  void draw(Context& context) override;
  bool key(Context& context, const Chord& chord) override {
    return page_ == PreferencesPage::Keymap && keys_.key(context, chord);
  }
  void escape(Context& context) override {
    if (!keys_.stop_waiting()) context.dialogs->close();
  }

 private:
  void draw_pages(Context& context, const Rect& rect);
  void draw_page(Context& context, const Rect& rect);
  void draw_interface(Context& context, Column& column);
  void draw_view(Context& context, Column& column);
  void draw_undo(Context& context, Column& column);
  void draw_jobs(Context& context, Column& column);
  void draw_folders(Context& context, Column& column);

  // Functions that draw a row of the dialog, with a label and a field. labelled() draws only the label, whose tooltip
  // is the description, and returns the area for the field.
  Rect labelled(Context& context, Column& column, const std::string& label, const std::string& description);
  void number(Context& context, Column& column, const std::string& label, const std::string& description, double low,
              double high, const char* format, const char* unit, const std::function<double&(Preferences&)>& value);
  void whole_number(Context& context, Column& column, const std::string& label, const std::string& description,
                    int Preferences::*value, int low, int high, const char* unit);
  void check(Context& context, Column& column, const std::string& label, const std::string& description, bool& on);
  void note(Context& context, Column& column, const std::string& text);

  PreferencesPage page_;
  KeymapPage keys_;
  std::string edited_;  // label of the number field that the user drags or types into; "": the user edits no number
  double edited_value_ = 0;
};

Rect PreferencesDialog::labelled(Context& context, Column& column, const std::string& label,
                                 const std::string& description) {
  const Look& look = context.ui->look;
  const Rect row = column.row(32);
  const Rect words{{row.low.x + look.px(16), row.low.y}, {row.low.x + look.px(206), row.high.y}};
  put_text(context.ui, look.fonts.regular, look.theme.text2, words, label);
  if (ImGui::IsWindowHovered() && words.contains(context.ui->input.pointer))
    tooltip(context.ui, words, label, description);
  return {{words.high.x + look.px(8), row.low.y + look.px(4)},
          {words.high.x + look.px(8 + 220), row.high.y - look.px(4)}};
}

void PreferencesDialog::number(Context& context, Column& column, const std::string& label,
                               const std::string& description, double low, double high, const char* format,
                               const char* unit, const std::function<double&(Preferences&)>& value) {
  const Rect rect = labelled(context, column, label, description);
  double shown = edited_ == label ? edited_value_ : value(context.preferences);
  bool committed = false;
  if (number_field(context.ui, label, rect, shown, low, high, format, unit, true, committed)) {
    edited_ = label;
    edited_value_ = shown;
  }
  if (ImGui::IsItemHovered())
    tooltip(context.ui, rect, label, description + "\nDrag the number, or click it and type.");
  if (!committed || edited_ != label) return;
  value(context.preferences) = edited_value_;
  edited_.clear();
  keep_preferences(context);
}

void PreferencesDialog::whole_number(Context& context, Column& column, const std::string& label,
                                     const std::string& description, int Preferences::*value, int low, int high,
                                     const char* unit) {
  double real = (*context.preferences).*value;
  number(context, column, label, description, low, high, "%.0f", unit, [&](Preferences&) -> double& { return real; });
  const int rounded = static_cast<int>(std::lround(real));
  if (rounded == (*context.preferences).*value) return;
  (*context.preferences).*value = rounded;
  keep_preferences(context);
}

void PreferencesDialog::check(Context& context, Column& column, const std::string& label,
                              const std::string& description, bool& on) {
  const Look& look = context.ui->look;
  const Rect row = column.row(30);
  const Rect rect{{row.low.x + look.px(16), row.low.y}, {row.low.x + look.px(434), row.high.y}};
  if (checkbox(context.ui, label, rect, label, on)) keep_preferences(context);
  if (ImGui::IsItemHovered()) tooltip(context.ui, rect, label, description);
}

void PreferencesDialog::note(Context& context, Column& column, const std::string& text) {
  const Look& look = context.ui->look;
  const Rect row = column.row(26);
  put_text(context.ui, look.fonts.small, look.theme.text2,
           Rect{{row.low.x + look.px(16), row.low.y}, {row.high.x - look.px(12), row.high.y}}, text);
}

void PreferencesDialog::draw_interface(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Rect theme = labelled(context, column, "Theme", "Dark or light colours. The views are dark in both themes.");
  const float half = std::round(theme.width() / 2);
  for (const auto& [name, label, left] :
       {std::tuple("dark", "Dark", theme.low.x), std::tuple("light", "Light", theme.low.x + half)}) {
    const bool chosen = context.preferences->theme == name;
    if (button(context.ui, label, {{left, theme.low.y}, {left + half - look.px(1), theme.high.y}},
               {"", label, chosen ? ButtonStyle::Chosen : ButtonStyle::Plain})) {
      context.preferences->theme = name;
      keep_preferences(context);
    }
  }
  number(context, column, "Scale", "Size of text and buttons, multiplied with the monitor's scale.", 0.75, 3, "%.2f",
         "\u00d7", [](Preferences& p) -> double& { return p.scale; });
  number(context, column, "Tooltip delay", "How long the pointer must rest on a control before its tooltip appears.", 0,
         3, "%.1f", "s", [](Preferences& p) -> double& { return p.tooltip_delay; });
  column.space(6);
  check(context, column, "Reduce motion", "Switch views and show messages immediately, without animation.",
        context.preferences->reduce_motion);
  check(context, column, "Advanced steps",
        "Show all tools of each workflow step in the sidebar, not only its main tool.",
        context.preferences->advanced_steps);
}

void PreferencesDialog::draw_view(Context& context, Column& column) {
  const Look& look = context.ui->look;
  Preferences& preferences = context.preferences;
  const Rect display = labelled(context, column, "Display", "How the body is displayed when the editor starts.");
  const float third = std::round(display.width() / 3);
  float x = display.low.x;
  for (const auto& [name, label, op] :
       {std::tuple("solid", "Solid", "view.solid"), std::tuple("xray", "X-ray", "view.xray_display"),
        std::tuple("tissue", "Tissue", "view.tissue")}) {
    const bool chosen = preferences.display == name;
    if (button(context.ui, label, {{x, display.low.y}, {x + third - look.px(1), display.high.y}},
               {"", label, chosen ? ButtonStyle::Chosen : ButtonStyle::Plain})) {
      preferences.display = name;
      run(context, op);
      keep_preferences(context);
    }
    x += third;
  }
  column.space(6);
  Views& views = *context.views;
  const auto overlay = [&](const char* label, const char* description, bool Preferences::*kept, bool Views::*shown) {
    check(context, column, label, description, preferences.*kept);
    views.*shown = preferences.*kept;
  };
  overlay("Grid", "Show the ground grid in the 3D view.", &Preferences::grid, &Views::grid);
  overlay("Axes", "Show the axis ball in the 3D view.", &Preferences::axes, &Views::axes);
  overlay("Scale bar", "Show a scale bar in every view.", &Preferences::scale_bar, &Views::scale_bar);
  overlay("Orientation letters", "Show letters for the directions of the body, such as L for left.",
          &Preferences::letters, &Views::letters);
  overlay("Cross-hair", "Show the cross-hair where the slices meet.", &Preferences::cross_hair,
          &Views::show_cross_hair);
  check(context, column, "Soft shadows when idle",
        "Compute soft shadows by ray tracing when nothing in the 3D view moves. Exported pictures and figures also "
        "have them.",
        preferences.fine_light);
  apply_light(context);
  check(context, column, "Refine the volume at rest",
        "Resample a pose that does not change in the background, and show the result instead of the preview.",
        preferences.refine_at_rest);
}

void PreferencesDialog::draw_undo(Context& context, Column& column) {
  whole_number(
      context, column, "Memory limit for undo",
      "Largest memory for undo steps. When edits need more memory than this, the oldest edits can no longer be undone.",
      &Preferences::undo_limit_mb, 64, 65536, "MB");
  const History& history = context.history;
  note(context, column,
       std::to_string(history.steps().size()) + " undo states take " + std::to_string(history.bytes() >> 20) +
           " MB now." + (history.note().empty() ? "" : " " + history.note()));
  column.space(6);
  whole_number(context, column, "Autosave every",
               "Save the project automatically at this interval, if it already has a file. 0 = never.",
               &Preferences::autosave_minutes, 0, 240, "min");
  note(context, column, "Every edit is also stored within a second and can be recovered after a crash.");
}

void PreferencesDialog::draw_jobs(Context& context, Column& column) {
  whole_number(context, column, "Parallel jobs", "Number of jobs that run at the same time. The others wait.",
               &Preferences::jobs_at_once, 1, 8, "");
  whole_number(context, column, "Resampling memory limit",
               "Stop a resampling that needs more memory than this, and show a message. 0 = unlimited.",
               &Preferences::worker_memory_mb, 0, 1 << 18, "MB");
  number(context, column, "Resampling time limit",
         "Stop a resampling that takes longer than this, and show a message. 0 = unlimited.", 0, 1440, "%.1f", "min",
         [](Preferences& p) -> double& { return p.worker_minutes; });
  note(context, column, "A resampling runs in a separate process: if it fails, the project is not affected.");
}

void PreferencesDialog::draw_folders(Context& context, Column& column) {
  Preferences& preferences = context.preferences;
  const Rect scratch = labelled(context, column, "Scratch folder",
                                "Folder for the temporary files of a resampling, which are deleted at its end.");
  const std::string before = preferences.scratch_folder;
  const Rect wide{scratch.low, {scratch.high.x + context.ui->look.px(110), scratch.high.y}};
  if (text_field(context.ui, "Scratch folder", wide, preferences.scratch_folder, "The system's temporary folder"))
    keep_preferences(context);
  if (ImGui::IsItemHovered())
    tooltip(context.ui, wide, "Scratch folder",
            "Folder for the temporary files of a resampling, which are deleted at its end.");
  column.space(6);
  note(context, column,
       "Preferences are stored in " +
           (context.preferences_state->path.empty() ? preferences_path() : context.preferences_state->path).string());
}

void PreferencesDialog::draw_pages(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  ImGui::GetWindowDrawList()->AddRectFilled(im(rect.low), im(rect.high), look.theme.head, look.px(8),
                                            ImDrawFlags_RoundCornersBottomLeft);
  float y = rect.low.y + look.px(8);
  for (int i = 0; i < std::ssize(kPages); ++i, y += look.px(32)) {
    const Rect row{{rect.low.x, y}, {rect.high.x, y + look.px(32)}};
    const bool chosen = static_cast<int>(page_) == i;
    const Pressed pressed = press_area(context.ui, kPages[i].title, row);
    if (chosen) fill(row, look.theme.accent_soft);
    else if (pressed.hovered) fill(row, look.theme.hover);
    const Colour colour = chosen ? look.theme.accent_text : look.theme.text2;
    put_icon(look.fonts.regular, colour,
             Rect{{row.low.x + look.px(12), row.low.y}, {row.low.x + look.px(32), row.high.y}}, kPages[i].icon);
    put_text(context.ui, look.fonts.regular, chosen ? look.theme.accent_text : look.theme.text,
             Rect{{row.low.x + look.px(40), row.low.y}, row.high}, kPages[i].title);
    if (!pressed.clicked) continue;
    keys_.stop_waiting();
    page_ = static_cast<PreferencesPage>(i);
  }
}

void PreferencesDialog::draw_page(Context& context, const Rect& rect) {
  if (page_ == PreferencesPage::Keymap) return keys_.draw(context, rect);
  Column column(context.ui, kPages[static_cast<int>(page_)].title, rect);
  column.space(10);
  switch (page_) {
    case PreferencesPage::Interface: return draw_interface(context, column);
    case PreferencesPage::Keymap: return;
    case PreferencesPage::View: return draw_view(context, column);
    case PreferencesPage::Undo: return draw_undo(context, column);
    case PreferencesPage::Jobs: return draw_jobs(context, column);
    case PreferencesPage::Folders: return draw_folders(context, column);
  }
}

void PreferencesDialog::draw(Context& context) {
  const Look& look = context.ui->look;
  const Rect rect = begin_dialog(context, "Preferences", 760, 440);
  const Rect body{rect.low - look.px(18), rect.high + look.px(18)};
  const float middle = body.low.x + look.px(176);
  draw_pages(context, {{body.low.x + look.line(), body.low.y}, {middle, body.high.y - look.line()}});
  fill({{middle, body.low.y}, {middle + look.line(), body.high.y - look.line()}}, look.theme.line2);
  draw_page(context, {{middle + look.line(), body.low.y}, {body.high.x - look.line(), body.high.y - look.px(4)}});
  end_dialog(context);
}

}  // namespace

std::unique_ptr<Dialog> open_preferences(PreferencesPage page, const std::string& search) {
  return std::make_unique<PreferencesDialog>(page, search);
}

}  // namespace limber::editor
