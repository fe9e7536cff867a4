// SPDX-License-Identifier: AGPL-3.0-or-later
#include <ctime>
#include <utility>

#include <imgui_internal.h>

#include "core/platform/desktop.h"
#include "core/study/text.h"
#include "core/volume_io/volume_format.h"
#include "editor/context/context.h"
#include "editor/context/recent_files.h"
#include "editor/context/user_folders.h"
#include "editor/dialogs/dialog.h"
#include "editor/file_browser/file_browser_dialog.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/messages.h"
#include "editor/ui/section.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 760, kHeight = 520, kPlaces = 160, kRow = 24;

bool pressed(Key key) { return ImGui::IsKeyPressed(static_cast<int>(key), false); }
bool pressed_return() { return pressed(Key::Return) || pressed(Key::NumEnter); }

}  // namespace

void FileBrowser::draw(Context& context) {
  follow(context);
  const Look& look = context.ui->look;
  const Rect rect = begin_dialog(context, request_.title, kWidth, kHeight, [&] { leave(context); });
  const Rect whole{rect.low - glm::vec2(look.px(18)), rect.high + look.px(18)};
  const float foot = look.px(52), top = look.px(44), split = whole.low.x + look.px(kPlaces);
  take_keys(context);
  draw_places(context, {{whole.low.x, whole.low.y}, {split, whole.high.y - foot}});
  draw_path(context, {{split, whole.low.y}, {whole.high.x, whole.low.y + top}});
  draw_list(context, {{split, whole.low.y + top}, {whole.high.x, whole.high.y - foot}});
  draw_foot(context, {{whole.low.x, whole.high.y - foot}, whole.high});
  end_dialog(context);
  seen_ = true;
  had_error_ = !context.messages->errors.empty();
}

void FileBrowser::draw_places(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const PathScope scope(context.ui, "places");
  ImGui::PushClipRect(im(rect.low), im(rect.high), true);
  fill({{rect.high.x - look.line(), rect.low.y}, rect.high}, look.theme.line);
  float y = rect.low.y + look.px(8);
  for (int i = 0; i < std::ssize(places_); ++i) {
    const Rect row{{rect.low.x + look.px(6), y}, {rect.high.x - look.px(8), y + look.px(kRow)}};
    const Pressed state = press_area(context.ui, places_[i].name, row);
    const bool here = places_[i].path == folder_;
    if (here || state.hovered) fill(row, here ? look.theme.accent_soft : look.theme.hover, look.px(4));
    if (focus_ == Focus::Places && i == place_) outline(row, look.theme.accent_text, look.px(4), 2 * look.line());
    put_icon(look.fonts.regular, here ? look.theme.accent_text : look.theme.text2,
             Rect{{row.low.x + look.px(6), row.low.y}, {row.low.x + look.px(24), row.high.y}}, places_[i].icon);
    put_text(context.ui, look.fonts.regular, here ? look.theme.text : look.theme.text2,
             Rect{{row.low.x + look.px(30), row.low.y}, {row.high.x - look.px(4), row.high.y}}, places_[i].name);
    if (state.hovered) tooltip(context.ui, row, places_[i].name, short_path(places_[i].path));
    if (state.clicked) go_to(context, places_[i].path);
    y = row.high.y;
  }
  ImGui::PopClipRect();
}

void FileBrowser::draw_path(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const float search_width = saving() ? 0 : look.px(190), middle = rect.centre().y, half = look.px(13);
  const Rect up{{rect.low.x + look.px(10), middle - half}, {rect.low.x + look.px(36), middle + half}};
  if (button(context.ui, "Up", up, {"\uf062", "", ButtonStyle::Flat, folder_ != "/"})) go_up(context);
  if (ImGui::IsItemHovered()) tooltip(context.ui, up, "Up", "Go to the parent folder (Backspace).");
  const PathScope scope(context.ui, "path");
  std::vector<Path> steps;
  for (Path step = folder_;; step = step.parent_path()) {
    steps.push_back(step);
    if (step == step.parent_path()) break;
  }
  const float left = up.high.x + look.px(6), right = rect.high.x - look.px(14) - search_width;
  float needed = 0;
  std::size_t shown = 0;
  for (; shown < steps.size(); ++shown) {
    const float width = text_size(look.fonts.regular, crumb(steps[shown])).x + look.px(28);
    if (shown > 0 && needed + width > right - left - look.px(20)) break;
    needed += width;
  }
  float x = left;
  if (shown < steps.size())
    x = put_text(context.ui, look.fonts.regular, look.theme.text3, {x, middle - look.px(8)}, "\u2026") + look.px(6);
  for (std::size_t i = shown; i-- > 0;) {
    const std::string name = crumb(steps[i]);
    const float width = std::min(text_size(look.fonts.regular, name).x + look.px(12), right - x);
    const Rect place{{x, middle - half}, {x + width, middle + half}};
    const Pressed state = press_area(context.ui, name, place);
    if (state.hovered) fill(place, look.theme.hover, look.px(4));
    put_text(context.ui, i == 0 ? look.fonts.semibold : look.fonts.regular, i == 0 ? look.theme.text : look.theme.text2,
             place, name, Align::Centre);
    if (state.clicked && i > 0) go_to(context, steps[i]);
    x = place.high.x;
    if (i > 0)
      put_icon(look.fonts.small, look.theme.text3, Rect{{x, place.low.y}, {x + look.px(14), place.high.y}},
               icon::kClosed);
    x += look.px(14);
  }
  if (!saving())
    draw_search(context, {{rect.high.x - look.px(10) - search_width, middle - half},
                          {rect.high.x - look.px(10), middle + half}});
}

std::string FileBrowser::crumb(const Path& path) {
  return path == "/" ? "/" : path == home_folder() ? "Home" : path.filename().string();
}

void FileBrowser::draw_search(Context& context, const Rect& rect) {
  const std::string before = search_;
  ImGui::PushID(text_);
  text_field(context.ui, "Search names", rect, search_, "Search or type a path", wants_focus(context));
  ImGui::PopID();
  if (search_ != before) {
    changed_ = reveal_ = true;
    row_ = 0;
    remark_.clear();
    context.ui->touch();
  }
}

bool FileBrowser::wants_focus(Context& context) {
  if (focus_ != Focus::List || new_folder_ || replace_ || filter_open_ || ImGui::IsAnyItemActive() ||
      context.ui->input.buttons[0])
    return false;
  const bool wanted = refocus_ || !ImGui::GetIO().WantTextInput;
  refocus_ = false;
  if (wanted) context.ui->touch();
  return wanted;
}

void FileBrowser::draw_list(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const float date = look.px(110), size = look.px(80);
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(kRow)}};
  fill(head, look.theme.head);
  // The titles leave room for the scroll bar, as the rows below do, so that each title stands above its column.
  const float right = head.high.x - ImGui::GetStyle().ScrollbarSize - look.px(14), date_left = right - date,
              size_left = date_left - size;
  column_head(context, "Name", {{head.low.x + look.px(10), head.low.y}, {size_left, head.high.y}}, SortBy::Name,
              Align::Left);
  column_head(context, "Size", {{size_left, head.low.y}, {date_left, head.high.y}}, SortBy::Size, Align::Right);
  column_head(context, "Modified", {{date_left, head.low.y}, {right, head.high.y}}, SortBy::Time, Align::Right);

  Rect list{{rect.low.x, head.high.y}, rect.high};
  if (offers_dicom()) list.low.y = draw_dicom_offer(context, {list.low, {list.high.x, list.low.y + look.px(40)}});
  if (new_folder_) list.low.y = draw_new_folder(context, {list.low, {list.high.x, list.low.y + look.px(34)}});
  if (rows_.empty()) return draw_empty(context, list);
  const PathScope scope(context.ui, "list");
  Column column(context.ui, "rows", list);
  const float top = ImGui::GetScrollY();
  const std::int64_t now = std::time(nullptr);
  int open = -1;
  for (int i = 0; i < std::ssize(rows_); ++i) {
    Rect row;
    const float y = static_cast<float>(i) * look.px(kRow);
    if (i == row_ && std::exchange(reveal_, false)) {
      if (y < top) ImGui::SetScrollY(y);
      else if (y + look.px(kRow) > top + list.height()) ImGui::SetScrollY(y + look.px(kRow) - list.height());
    }
    if (!column.list_row(row, i, i == row_ && (!saving() || row_moved_))) continue;
    if (draw_row(context, contents_.entries[rows_[i]], row, i, {size_left, date_left}, now)) open = i;
  }
  if (open >= 0) open_row(context, open);
}

bool FileBrowser::draw_row(Context& context, const DirectoryEntry& entry, const Rect& row, int index,
                           const glm::vec2& columns, std::int64_t now) {
  const Look& look = context.ui->look;
  const Pressed state = press_area(context.ui, entry.name, row);
  if (state.hovered && index != row_) fill(row, look.theme.hover);
  if (index == row_ && focus_ == Focus::List && (!saving() || row_moved_))
    outline(row, look.theme.accent_text, 0, look.line());
  if (state.activated) {
    row_ = index;
    row_moved_ = true;
    focus_ = Focus::List;
    remark_.clear();
    if (saving() && !entry.folder) set_name(entry.name);
  }
  const bool project = entry.name.ends_with(".limber");
  put_icon(look.fonts.regular,
           entry.folder ? look.theme.accent_text
           : project    ? look.theme.select
                        : look.theme.text2,
           Rect{{row.low.x + look.px(10), row.low.y}, {row.low.x + look.px(28), row.high.y}},
           entry.folder ? icon::kFolder
           : project    ? icon::kRig
                        : icon_of(entry.name));
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{row.low.x + look.px(34), row.low.y}, {columns.x + look.px(8), row.high.y}}, entry.name);
  if (!entry.folder)
    put_text(context.ui, look.fonts.mono, look.theme.text2, Rect{{columns.x, row.low.y}, {columns.y, row.high.y}},
             size_text(entry.size), Align::Right);
  put_text(context.ui, look.fonts.small, look.theme.text2,
           Rect{{columns.y, row.low.y}, {row.high.x - look.px(14), row.high.y}}, time_text(entry.time, now),
           Align::Right);
  return state.double_clicked;
}

const char* FileBrowser::icon_of(const std::string& name) {
  static const FileFilter volumes = [] {
    FileFilter all{"", {}};
    for (const VolumeFormat& format : volume_formats())
      all.ends.insert(all.ends.end(), format.endings.begin(), format.endings.end());
    return all;
  }();
  if (matches(volumes, name)) return icon::kVolume;
  if (matches({"", {".bvh"}}, name)) return icon::kMotion;
  return icon::kNew;
}

void FileBrowser::column_head(Context& context, const char* title, const Rect& rect, SortBy by, Align align) {
  const Look& look = context.ui->look;
  const Pressed state = press_area(context.ui, title, rect);
  std::string words = title;
  if (by_ == by) words += falling_ ? " \u2193" : " \u2191";
  put_text(context.ui, look.fonts.small, by_ == by || state.hovered ? look.theme.text : look.theme.text2, rect, words,
           align);
  if (!state.clicked) return;
  // The first click on a column sorts sizes and dates in descending order; the next click reverses the order.
  falling_ = by_ == by ? !falling_ : by != SortBy::Name;
  by_ = by;
  changed_ = reveal_ = true;
}

float FileBrowser::draw_dicom_offer(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  fill(rect, look.theme.head);
  fill({rect.low, {rect.low.x + look.px(3), rect.high.y}}, look.theme.accent_text);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {rect.high.x - look.px(190), rect.high.y}},
           "This folder contains DICOM images");
  const Rect place{{rect.high.x - look.px(180), rect.low.y + look.px(7)},
                   {rect.high.x - look.px(10), rect.high.y - look.px(7)}};
  if (button(context.ui, "Open as one volume", place, {icon::kVolume, "Open as one volume"})) finish_folder(context);
  return rect.high.y;
}

float FileBrowser::draw_new_folder(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  fill(rect, look.theme.head);
  const Rect field{{rect.low.x + look.px(10), rect.low.y + look.px(5)},
                   {rect.high.x - look.px(190), rect.high.y - look.px(5)}};
  const bool focus = std::exchange(focus_new_folder_, false);
  text_field(context.ui, "New folder's name", field, *new_folder_, "Name of the new folder", focus);
  if (button(context.ui, "Create folder",
             {{rect.high.x - look.px(180), field.low.y}, {rect.high.x - look.px(88), field.high.y}},
             {"", "Create", ButtonStyle::Plain}) ||
      pressed_return()) {
    make_folder(context);
    return rect.high.y;
  }
  if (button(context.ui, "Cancel new folder",
             {{rect.high.x - look.px(80), field.low.y}, {rect.high.x - look.px(10), field.high.y}},
             {"", "Cancel", ButtonStyle::Flat}))
    new_folder_.reset();
  return rect.high.y;
}

void FileBrowser::draw_empty(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  std::string words = !contents_.failure.empty() ? contents_.failure : !contents_.complete ? "Reading\u2026" : "";
  if (words.empty() && !search_.empty() && !path_is_typed()) words = "No name contains \u201c" + search_ + "\u201d";
  if (words.empty() && path_is_typed()) words = "Press Return to open this path";
  if (words.empty())
    words = contents_.entries.empty() ? "This folder is empty"
            : folders_only()          ? "This folder contains no folders"
                                      : "This folder contains no files of this type";
  put_text(context.ui, look.fonts.regular, contents_.failure.empty() ? look.theme.text2 : look.theme.warn, rect, words,
           Align::Centre);
}

void FileBrowser::draw_foot(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.line);
  const float low = rect.centre().y - look.px(14), high = rect.centre().y + look.px(14);
  if (replace_) return draw_replace(context, rect);
  float x = rect.low.x + look.px(12);
  if (button(context.ui, "New folder", {{x, low}, {x + look.px(30), high}}, {icon::kAdd, "", ButtonStyle::Flat})) {
    new_folder_ = "";
    focus_new_folder_ = true;
  }
  if (ImGui::IsItemHovered())
    tooltip(context.ui, {{x, low}, {x + look.px(30), high}}, "New folder",
            "Create a new folder in the folder that is shown.");
  x += look.px(34);
  bool hidden = context.recent_files->hidden_files;
  if (checkbox(context.ui, "Hidden files", {{x, low}, {x + look.px(104), high}}, "Hidden files", hidden))
    toggle_hidden(context);
  x = rect.low.x + look.px(kPlaces + 10);

  float right = rect.high.x - look.px(12);
  const float accept_width = std::max(look.px(88), text_size(look.fonts.semibold, request_.action).x + look.px(30));
  const bool can = saving() ? !name_.empty() : folders_only() || chosen() || path_is_typed();
  const bool pressed_accept = button(context.ui, "Accept", {{right - accept_width, low}, {right, high}},
                                     {"", request_.action, ButtonStyle::Primary, can});
  right -= accept_width + look.px(8);
  if (button(context.ui, "Cancel", {{right - look.px(76), low}, {right, high}}, {"", "Cancel"})) leave(context);
  right -= look.px(84);
  if (!folders_only()) right = draw_filter(context, {{right - look.px(170), low}, {right, high}}) - look.px(10);

  const Rect rest{{x, low}, {right, high}};
  if (saving()) {
    const std::string before = name_;
    ImGui::PushID(text_);
    text_field(context.ui, "Name", {{x, low + look.px(1)}, {right, high - look.px(1)}}, name_, "Name",
               wants_focus(context));
    ImGui::PopID();
    if (name_ != before) {
      row_moved_ = false;
      remark_.clear();
      context.ui->touch();
    }
  } else if (!remark_.empty()) {
    put_text(context.ui, look.fonts.small, look.theme.warn, rest, remark_);
  } else {
    const auto count = rows_.size();
    put_text(context.ui, look.fonts.small, look.theme.text2, rest,
             contents_.complete ? grouped(static_cast<std::int64_t>(count)) + (count == 1 ? " entry" : " entries")
                                : "Reading\u2026");
  }
  if (saving() && !remark_.empty()) context.messages->warn(std::exchange(remark_, ""));
  if (pressed_accept) folders_only() ? finish_folder(context) : accept(context);
}

float FileBrowser::draw_filter(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const Pressed state = press_area(context.ui, "Type", rect);
  fill(rect, state.hovered ? look.theme.hover : look.theme.raised, look.px(4));
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.high.x - look.px(24), rect.high.y}},
           request_.filters[filter_].name);
  put_icon(look.fonts.regular, look.theme.text2,
           Rect{{rect.high.x - look.px(24), rect.low.y}, {rect.high.x - look.px(6), rect.high.y}}, icon::kOpened);
  if (state.activated) ImGui::OpenPopup("types");
  ImGui::SetNextWindowPos(
      {rect.low.x, rect.low.y - look.px(24) * static_cast<float>(request_.filters.size()) - look.px(16)});
  filter_open_ = ImGui::BeginPopup("types", ImGuiWindowFlags_NoMove);
  if (!filter_open_) return rect.low.x;
  push_path(context.ui, "Type");
  if (pressed(Key::Escape)) ImGui::CloseCurrentPopup();
  for (int i = 0; i < std::ssize(request_.filters); ++i) {
    const glm::vec2 corner = from_im(ImGui::GetCursorScreenPos());
    const bool picked = ImGui::Selectable(("##" + request_.filters[i].name).c_str(), i == filter_, 0,
                                          ImVec2(rect.width(), look.px(20)));
    const Rect row{corner, corner + glm::vec2(rect.width(), look.px(20))};
    register_widget(context.ui, request_.filters[i].name, row);
    put_text(context.ui, look.fonts.regular, look.theme.text, Rect{{row.low.x + look.px(6), row.low.y}, row.high},
             request_.filters[i].name);
    if (picked) {
      if (saving()) take_ending(request_.filters[i]);
      filter_ = i;
      changed_ = true;
    }
  }
  pop_path(context.ui);
  ImGui::EndPopup();
  return rect.low.x;
}

void FileBrowser::draw_replace(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const float low = rect.centre().y - look.px(14), high = rect.centre().y + look.px(14);
  put_icon(look.fonts.regular, look.theme.warn, Rect{{rect.low.x + look.px(14), low}, {rect.low.x + look.px(34), high}},
           icon::kWarning);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(42), low}, {rect.high.x - look.px(210), high}},
           replace_->filename().string() + " already exists");
  float right = rect.high.x - look.px(12);
  const Path path = *replace_;
  if (button(context.ui, "Replace", {{right - look.px(88), low}, {right, high}}, {"", "Replace"}))
    return finish(context, path);
  right -= look.px(96);
  if (button(context.ui, "Keep file", {{right - look.px(88), low}, {right, high}},
             {"", "Keep file", ButtonStyle::Primary}))
    replace_.reset();
}

}  // namespace limber::editor
