// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/panels/file_browser.h"

#include <ctime>
#include <utility>

#include <imgui_internal.h>

#include "core/base/error.h"
#include "editor/dialog.h"
#include "editor/fields.h"
#include "editor/folders.h"
#include "editor/icons.h"
#include "editor/panels/column.h"
#include "editor/places.h"

namespace limber::editor {

namespace fs = std::filesystem;

namespace {

constexpr float kWidth = 760, kHeight = 520, kPlaces = 160, kRow = 24;
constexpr double kFirstWait = 0.08;  // s that the editor waits for a folder, so that most appear at once
constexpr int kPage = 12;            // rows of PageUp and PageDown

bool pressed(Key key, bool repeat = false) { return ImGui::IsKeyPressed(static_cast<int>(key), repeat); }
bool pressed_return() { return pressed(Key::Return) || pressed(Key::NumEnter); }

class FileBrowser final : public Dialog {
 public:
  FileBrowser(Editor& editor, FileRequest request) : request_(std::move(request)), places_(places_of(editor)), name_(request_.name) {
    if (request_.kind != FileRequest::Kind::OpenFolder) request_.filters.push_back({"All files", {}});
    const auto last = editor.remembered.folders.find(request_.purpose);
    Path begin = last != editor.remembered.folders.end() ? last->second : request_.folder;
    if (begin.empty() || !is_folder(begin)) begin = editor.project_path.empty() ? Path() : editor.project_path.parent_path();
    if (begin.empty() || !is_folder(begin)) begin = home_folder();
    go_to(editor, begin);
  }

  void escape(Editor& editor) override {
    if (replace_) return replace_.reset();
    if (new_folder_) return new_folder_.reset();
    if (filter_open_) return;
    if (!search_.empty() && !saving()) {
      search_.clear();
      ++text_;
      refocus_ = changed_ = true;
      return;
    }
    editor.close_dialog();
  }

  void draw(Editor& editor) override {
    follow(editor);
    const Look& look = editor.look;
    const Rect rect = begin_dialog(editor, request_.title, kWidth, kHeight);
    const Rect whole{rect.low - glm::vec2(look.px(18)), rect.high + look.px(18)};
    const float foot = look.px(52), top = look.px(44), split = whole.low.x + look.px(kPlaces);
    take_keys(editor);
    draw_places(editor, {{whole.low.x, whole.low.y}, {split, whole.high.y - foot}});
    draw_path(editor, {{split, whole.low.y}, {whole.high.x, whole.low.y + top}});
    draw_list(editor, {{split, whole.low.y + top}, {whole.high.x, whole.high.y - foot}});
    draw_foot(editor, {{whole.low.x, whole.high.y - foot}, whole.high});
    end_dialog(editor);
    seen_ = true;
    had_error_ = !editor.messages.errors.empty();
  }

 private:
  enum class Focus { List, Places };
  bool saving() const { return request_.kind == FileRequest::Kind::Save; }
  bool folders_only() const { return request_.kind == FileRequest::Kind::OpenFolder; }

  void go_to(Editor& editor, const Path& folder) {
    const std::string came_from = folder_.parent_path() == folder ? folder_.filename().string() : "";
    folder_ = folder.lexically_normal();
    if (folder_ != "/" && !folder_.has_filename()) folder_ = folder_.parent_path();
    contents_ = {};
    rows_.clear();
    reader_ = std::make_unique<DirectoryReader>(folder_, [&host = editor.host] { host.wake(); });
    reader_->wait(kFirstWait);
    if (!saving()) search_.clear();
    ++text_;
    select_after_reading_ = came_from;
    row_ = 0;
    refocus_ = changed_ = true;
    editor.touch();
  }

  // What has been read meanwhile, and the rows it makes.
  void follow(Editor& editor) {
    if (auto news = reader_->news()) {
      const std::string at = chosen() ? chosen()->name : select_after_reading_;
      contents_ = std::move(*news);
      arrange_rows(editor);
      select(at);
    } else if (changed_) {
      const std::string at = chosen() ? chosen()->name : select_after_reading_;
      arrange_rows(editor);
      select(at);
    }
    if (!contents_.complete) editor.wake_at(editor.now);
  }

  void arrange_rows(Editor& editor) {
    changed_ = false;
    DirectoryView view{.search = saving() ? "" : path_is_typed() ? "" : search_, .hidden = editor.remembered.hidden_files, .folders_only = folders_only(), .by = by_, .falling = falling_};
    if (!folders_only()) view.filter = &request_.filters[filter_];
    rows_ = shown_entries(contents_.entries, view);
    row_ = std::clamp(row_, 0, std::max(0, static_cast<int>(rows_.size()) - 1));
  }

  const DirectoryEntry* chosen() const { return row_ < std::ssize(rows_) ? &contents_.entries[rows_[row_]] : nullptr; }

  void select(const std::string& name) {
    if (name.empty()) return;
    for (int i = 0; i < std::ssize(rows_); ++i)
      if (contents_.entries[rows_[i]].name == name) {
        row_ = i;
        reveal_ = true;
        select_after_reading_.clear();
        return;
      }
  }

  bool path_is_typed() const { return search_.starts_with("/") || search_.starts_with("~"); }

  // ---- keys: everything without a mouse

  void take_keys(Editor& editor) {
    if (!seen_ || had_error_ || replace_ || new_folder_ || filter_open_) return;
    const bool alt = editor.input.down(Key::Alt), ctrl = editor.input.down(Key::Ctrl);
    if (ctrl && pressed(Key::H)) toggle_hidden(editor);
    if (pressed(Key::Tab)) {
      focus_ = focus_ == Focus::List ? Focus::Places : Focus::List;
      refocus_ = focus_ == Focus::List;
      if (focus_ == Focus::Places) ImGui::ClearActiveID();
    }
    if ((alt && pressed(Key::Up)) || (pressed(Key::Backspace) && text_was_empty_)) return go_up(editor);
    text_was_empty_ = saving() ? name_.empty() : search_.empty();
    if (alt) return;
    if (focus_ == Focus::Places) {
      const int last = static_cast<int>(places_.size()) - 1;
      if (pressed(Key::Down, true)) place_ = std::min(place_ + 1, last);
      if (pressed(Key::Up, true)) place_ = std::max(place_ - 1, 0);
      if (pressed_return() && place_ <= last) {
        focus_ = Focus::List;
        go_to(editor, places_[place_].path);
      }
      return;
    }
    move_row(editor);
    if (pressed_return()) accept(editor);
  }

  void move_row(Editor&) {
    const int before = row_, last = std::max(0, static_cast<int>(rows_.size()) - 1);
    if (pressed(Key::Down, true)) row_ += 1;
    if (pressed(Key::Up, true)) row_ -= 1;
    if (pressed(Key::PageDown, true)) row_ += kPage;
    if (pressed(Key::PageUp, true)) row_ -= kPage;
    if (!saving() && search_.empty() && pressed(Key::Home)) row_ = 0;
    if (!saving() && search_.empty() && pressed(Key::End)) row_ = last;
    row_ = std::clamp(row_, 0, last);
    if (row_ == before) return;
    reveal_ = row_moved_ = true;
    if (saving() && chosen() && !chosen()->folder) set_name(chosen()->name);
  }

  // A field that is being typed in knows only what was typed: a text from elsewhere makes it another field.
  void set_name(const std::string& name) {
    name_ = name;
    ++text_;
    refocus_ = true;
  }

  void go_up(Editor& editor) {
    if (folder_.has_parent_path() && folder_ != folder_.parent_path()) go_to(editor, folder_.parent_path());
  }

  void toggle_hidden(Editor& editor) {
    editor.remembered.hidden_files = !editor.remembered.hidden_files;
    changed_ = true;
  }

  // ---- what is chosen

  void finish(Editor& editor, const Path& path) {
    editor.remembered.folders[request_.purpose] = is_folder(path) && folders_only() ? path : path.parent_path();
    const auto act = request_.chosen;
    editor.close_dialog();
    editor.touch();
    attempt(editor, request_.title, [&](Editor& e) { act(e, path); });
  }

  // Return or the primary button.
  void accept(Editor& editor) {
    if (!saving() && path_is_typed()) return accept_typed(editor);
    const DirectoryEntry* entry = chosen();
    if (saving()) {
      if (row_moved_ && entry && entry->folder) return enter(editor, *entry);
      return accept_name(editor);
    }
    if (!entry) return;
    if (entry->folder) return enter(editor, *entry);
    finish(editor, folder_ / entry->name);
  }

  void accept_typed(Editor& editor) {
    const Path typed = search_.starts_with("~") ? home_folder() / Path(search_.substr(1)).relative_path() : Path(search_);
    std::error_code error;
    if (is_folder(typed)) return go_to(editor, typed);
    if (!folders_only() && fs::exists(typed, error)) return finish(editor, typed);
    remark_ = "There is no such file";
  }

  void accept_name(Editor& editor) {
    if (name_.empty()) return;
    Path path = name_.starts_with("~") ? home_folder() / Path(name_.substr(1)).relative_path() : Path(name_);
    if (path.is_relative()) path = folder_ / path;
    path = path.lexically_normal();
    if (is_folder(path)) {
      set_name(request_.name);
      return go_to(editor, path);
    }
    const FileFilter& filter = request_.filters[filter_];
    if (!filter.ends.empty() && !matches(filter, path.filename().string())) path += filter.ends.front();
    if (!is_folder(path.parent_path())) return void(remark_ = "There is no folder " + short_path(path.parent_path()));
    std::error_code error;
    if (fs::exists(path, error)) return void(replace_ = path);
    finish(editor, path);
  }

  void enter(Editor& editor, const DirectoryEntry& entry) {
    row_moved_ = false;
    go_to(editor, folder_ / entry.name);
  }

  void make_folder(Editor& editor) {
    const Path path = folder_ / *new_folder_;
    if (new_folder_->empty() || new_folder_->find('/') != std::string::npos) return void(remark_ = "A folder's name is not empty and holds no /");
    std::error_code error;
    if (!fs::create_directory(path, error)) return void(remark_ = error ? "The folder cannot be made: " + error.message() : "It is there already");
    new_folder_.reset();
    go_to(editor, path);
  }

  // ---- drawing

  void draw_places(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    const PathScope scope(editor, "places");
    ImGui::PushClipRect(im(rect.low), im(rect.high), true);
    fill({{rect.high.x - look.line(), rect.low.y}, rect.high}, look.theme.line);
    float y = rect.low.y + look.px(8);
    for (int i = 0; i < std::ssize(places_); ++i) {
      const Rect row{{rect.low.x + look.px(6), y}, {rect.high.x - look.px(8), y + look.px(kRow)}};
      const Pressed state = press_area(editor, places_[i].name, row);
      const bool here = places_[i].path == folder_;
      if (here || state.hovered) fill(row, here ? look.theme.accent_soft : look.theme.hover, look.px(4));
      if (focus_ == Focus::Places && i == place_) outline(row, look.theme.accent_text, look.px(4), 2 * look.line());
      put_icon(look.fonts.regular, here ? look.theme.accent_text : look.theme.text2, Rect{{row.low.x + look.px(6), row.low.y}, {row.low.x + look.px(24), row.high.y}}, places_[i].icon);
      put_text(editor, look.fonts.regular, here ? look.theme.text : look.theme.text2, Rect{{row.low.x + look.px(30), row.low.y}, {row.high.x - look.px(4), row.high.y}}, places_[i].name);
      if (state.hovered) tooltip(editor, row, places_[i].name, short_path(places_[i].path));
      if (state.clicked) go_to(editor, places_[i].path);
      y = row.high.y;
    }
    ImGui::PopClipRect();
  }

  // Crumbs, from the left as many of the last as fit; at the right the search.
  void draw_path(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    const float search_width = saving() ? 0 : look.px(190), middle = rect.centre().y, half = look.px(13);
    const Rect up{{rect.low.x + look.px(10), middle - half}, {rect.low.x + look.px(36), middle + half}};
    if (button(editor, "Up", up, {"\uf062", "", ButtonStyle::Flat, folder_ != "/"})) go_up(editor);
    if (ImGui::IsItemHovered()) tooltip(editor, up, "Up", "To the folder that this one is in (Backspace).");
    const PathScope scope(editor, "path");
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
    if (shown < steps.size()) x = put_text(editor, look.fonts.regular, look.theme.text3, {x, middle - look.px(8)}, "\u2026") + look.px(6);
    for (std::size_t i = shown; i-- > 0;) {
      const std::string name = crumb(steps[i]);
      const float width = std::min(text_size(look.fonts.regular, name).x + look.px(12), right - x);
      const Rect place{{x, middle - half}, {x + width, middle + half}};
      const Pressed state = press_area(editor, name, place);
      if (state.hovered) fill(place, look.theme.hover, look.px(4));
      put_text(editor, i == 0 ? look.fonts.semibold : look.fonts.regular, i == 0 ? look.theme.text : look.theme.text2, place, name, Align::Centre);
      if (state.clicked && i > 0) go_to(editor, steps[i]);
      x = place.high.x;
      if (i > 0) put_icon(look.fonts.small, look.theme.text3, Rect{{x, place.low.y}, {x + look.px(14), place.high.y}}, icon::kClosed);
      x += look.px(14);
    }
    if (!saving()) draw_search(editor, {{rect.high.x - look.px(10) - search_width, middle - half}, {rect.high.x - look.px(10), middle + half}});
  }

  static std::string crumb(const Path& path) { return path == "/" ? "/" : path == home_folder() ? "Home" : path.filename().string(); }

  void draw_search(Editor& editor, const Rect& rect) {
    const std::string before = search_;
    ImGui::PushID(text_);
    text_field(editor, "Search names", rect, search_, "Type to search, or a path", wants_focus(editor));
    ImGui::PopID();
    if (search_ != before) {
      changed_ = reveal_ = true;
      row_ = 0;
      remark_.clear();
      editor.touch();
    }
  }

  // The one field of text has the keyboard whenever nothing else is being pressed.
  bool wants_focus(Editor& editor) {
    if (focus_ != Focus::List || new_folder_ || replace_ || filter_open_ || ImGui::IsAnyItemActive() || editor.input.buttons[0]) return false;
    const bool wanted = refocus_ || !ImGui::GetIO().WantTextInput;
    refocus_ = false;
    if (wanted) editor.touch();
    return wanted;
  }

  void draw_list(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    const float date = look.px(110), size = look.px(80);
    const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(kRow)}};
    fill(head, look.theme.head);
    const float size_left = head.high.x - look.px(14) - date - size, date_left = head.high.x - look.px(14) - date;
    column_head(editor, "Name", {{head.low.x + look.px(10), head.low.y}, {size_left, head.high.y}}, SortBy::Name, Align::Left);
    column_head(editor, "Size", {{size_left, head.low.y}, {date_left, head.high.y}}, SortBy::Size, Align::Right);
    column_head(editor, "Changed", {{date_left, head.low.y}, {head.high.x - look.px(14), head.high.y}}, SortBy::Time, Align::Right);

    Rect list{{rect.low.x, head.high.y}, rect.high};
    if (offers_dicom()) list.low.y = draw_dicom_offer(editor, {list.low, {list.high.x, list.low.y + look.px(40)}});
    if (new_folder_) list.low.y = draw_new_folder(editor, {list.low, {list.high.x, list.low.y + look.px(34)}});
    if (rows_.empty()) return draw_empty(editor, list);
    const PathScope scope(editor, "list");
    Column column(editor, "rows", list);
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
      if (draw_row(editor, contents_.entries[rows_[i]], row, i, {size_left, date_left}, now)) open = i;
    }
    if (open >= 0) open_row(editor, open);
  }

  // True when it is to be opened.
  bool draw_row(Editor& editor, const DirectoryEntry& entry, const Rect& row, int index, const glm::vec2& columns, std::int64_t now) {
    const Look& look = editor.look;
    const Pressed state = press_area(editor, entry.name, row);
    if (state.hovered && index != row_) fill(row, look.theme.hover);
    if (index == row_ && focus_ == Focus::List && (!saving() || row_moved_)) outline(row, look.theme.accent_text, 0, look.line());
    if (state.activated) {
      row_ = index;
      row_moved_ = true;
      focus_ = Focus::List;
      remark_.clear();
      if (saving() && !entry.folder) set_name(entry.name);
    }
    const bool project = entry.name.ends_with(".limber");
    put_icon(look.fonts.regular, entry.folder ? look.theme.accent_text : project ? look.theme.select : look.theme.text2,
             Rect{{row.low.x + look.px(10), row.low.y}, {row.low.x + look.px(28), row.high.y}}, entry.folder ? icon::kFolder : project ? icon::kRig : icon_of(entry.name));
    put_text(editor, look.fonts.regular, look.theme.text, Rect{{row.low.x + look.px(34), row.low.y}, {columns.x + look.px(8), row.high.y}}, entry.name);
    if (!entry.folder) put_text(editor, look.fonts.mono, look.theme.text2, Rect{{columns.x, row.low.y}, {columns.y, row.high.y}}, size_text(entry.size), Align::Right);
    put_text(editor, look.fonts.small, look.theme.text2, Rect{{columns.y, row.low.y}, {row.high.x - look.px(14), row.high.y}}, time_text(entry.time, now), Align::Right);
    return state.double_clicked;
  }

  static const char* icon_of(const std::string& name) {
    const FileFilter volumes{"", {".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".hdr", ".img", ".dcm", ".raw"}};
    if (matches(volumes, name)) return icon::kVolume;
    if (matches({"", {".bvh"}}, name)) return icon::kMotion;
    return icon::kNew;
  }

  void open_row(Editor& editor, int index) {
    row_ = index;
    const DirectoryEntry entry = contents_.entries[rows_[index]];
    if (entry.folder) return enter(editor, entry);
    saving() ? accept_name(editor) : finish(editor, folder_ / entry.name);
  }

  void column_head(Editor& editor, const char* title, const Rect& rect, SortBy by, Align align) {
    const Look& look = editor.look;
    const Pressed state = press_area(editor, title, rect);
    std::string words = title;
    if (by_ == by) words += falling_ ? " \u2193" : " \u2191";
    put_text(editor, look.fonts.small, by_ == by || state.hovered ? look.theme.text : look.theme.text2, rect, words, align);
    if (!state.clicked) return;
    falling_ = by_ == by ? !falling_ : by != SortBy::Name;  // the largest and the latest first
    by_ = by;
    changed_ = reveal_ = true;
  }

  bool offers_dicom() const { return request_.takes_dicom && contents_.holds_dicom; }

  float draw_dicom_offer(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    fill(rect, look.theme.head);
    fill({rect.low, {rect.low.x + look.px(3), rect.high.y}}, look.theme.accent_text);
    put_text(editor, look.fonts.regular, look.theme.text, Rect{{rect.low.x + look.px(14), rect.low.y}, {rect.high.x - look.px(190), rect.high.y}}, "This folder holds DICOM images");
    const Rect place{{rect.high.x - look.px(180), rect.low.y + look.px(7)}, {rect.high.x - look.px(10), rect.high.y - look.px(7)}};
    if (button(editor, "Open as one volume", place, {icon::kVolume, "Open as one volume"})) finish_folder(editor);
    return rect.high.y;
  }

  void finish_folder(Editor& editor) {
    editor.remembered.folders[request_.purpose] = folder_;
    const auto act = request_.chosen;
    editor.close_dialog();
    editor.touch();
    attempt(editor, request_.title, [act, path = folder_](Editor& e) { act(e, path); });
  }

  float draw_new_folder(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    fill(rect, look.theme.head);
    const Rect field{{rect.low.x + look.px(10), rect.low.y + look.px(5)}, {rect.high.x - look.px(190), rect.high.y - look.px(5)}};
    const bool focus = std::exchange(focus_new_folder_, false);
    text_field(editor, "New folder's name", field, *new_folder_, "Name of the new folder", focus);
    if (button(editor, "Make folder", {{rect.high.x - look.px(180), field.low.y}, {rect.high.x - look.px(88), field.high.y}}, {"", "Make", ButtonStyle::Plain}) || pressed_return()) {
      make_folder(editor);
      return rect.high.y;
    }
    if (button(editor, "No folder", {{rect.high.x - look.px(80), field.low.y}, {rect.high.x - look.px(10), field.high.y}}, {"", "Cancel", ButtonStyle::Flat})) new_folder_.reset();
    return rect.high.y;
  }

  void draw_empty(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    std::string words = !contents_.failure.empty() ? contents_.failure : !contents_.complete ? "Reading\u2026" : "";
    if (words.empty() && !search_.empty() && !path_is_typed()) words = "No name holds \u201c" + search_ + "\u201d";
    if (words.empty() && path_is_typed()) words = "Return goes to this path";
    if (words.empty()) words = contents_.entries.empty() ? "This folder is empty" : folders_only() ? "No folders here" : "Nothing of this type here";
    put_text(editor, look.fonts.regular, contents_.failure.empty() ? look.theme.text2 : look.theme.warn, rect, words, Align::Centre);
  }

  void draw_foot(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.line);
    const float low = rect.centre().y - look.px(14), high = rect.centre().y + look.px(14);
    if (replace_) return draw_replace(editor, rect);
    float x = rect.low.x + look.px(12);
    if (button(editor, "New folder", {{x, low}, {x + look.px(30), high}}, {icon::kAdd, "", ButtonStyle::Flat})) {
      new_folder_ = "";
      focus_new_folder_ = true;
    }
    if (ImGui::IsItemHovered()) tooltip(editor, {{x, low}, {x + look.px(30), high}}, "New folder", "Makes a folder in the one that is shown.");
    x += look.px(34);
    bool hidden = editor.remembered.hidden_files;
    if (checkbox(editor, "Hidden files", {{x, low}, {x + look.px(104), high}}, "Hidden files", hidden)) toggle_hidden(editor);
    x = rect.low.x + look.px(kPlaces + 10);

    float right = rect.high.x - look.px(12);
    const float accept_width = std::max(look.px(88), text_size(look.fonts.semibold, request_.action).x + look.px(30));
    const bool can = saving() ? !name_.empty() : folders_only() || chosen() || path_is_typed();
    const bool pressed_accept = button(editor, "Accept", {{right - accept_width, low}, {right, high}}, {"", request_.action, ButtonStyle::Primary, can});
    right -= accept_width + look.px(8);
    if (button(editor, "Cancel", {{right - look.px(76), low}, {right, high}}, {"", "Cancel"})) editor.close_dialog();
    right -= look.px(84);
    if (!folders_only()) right = draw_filter(editor, {{right - look.px(170), low}, {right, high}}) - look.px(10);

    const Rect rest{{x, low}, {right, high}};
    if (saving()) {
      const std::string before = name_;
      ImGui::PushID(text_);
      text_field(editor, "Name", {{x, low + look.px(1)}, {right, high - look.px(1)}}, name_, "Name", wants_focus(editor));
      ImGui::PopID();
      if (name_ != before) {
        row_moved_ = false;
        remark_.clear();
        editor.touch();
      }
    } else if (!remark_.empty()) {
      put_text(editor, look.fonts.small, look.theme.warn, rest, remark_);
    } else {
      const auto count = rows_.size();
      put_text(editor, look.fonts.small, look.theme.text2, rest, contents_.complete ? std::to_string(count) + (count == 1 ? " entry" : " entries") : "Reading\u2026");
    }
    if (saving() && !remark_.empty()) editor.messages.warn(std::exchange(remark_, ""));
    if (pressed_accept) folders_only() ? finish_folder(editor) : accept(editor);
  }

  float draw_filter(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    const Pressed state = press_area(editor, "Type", rect);
    fill(rect, state.hovered ? look.theme.hover : look.theme.raised, look.px(4));
    put_text(editor, look.fonts.regular, look.theme.text, Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.high.x - look.px(24), rect.high.y}}, request_.filters[filter_].name);
    put_icon(look.fonts.regular, look.theme.text2, Rect{{rect.high.x - look.px(24), rect.low.y}, {rect.high.x - look.px(6), rect.high.y}}, icon::kOpened);
    if (state.activated) ImGui::OpenPopup("types");
    ImGui::SetNextWindowPos({rect.low.x, rect.low.y - look.px(24) * static_cast<float>(request_.filters.size()) - look.px(16)});
    filter_open_ = ImGui::BeginPopup("types", ImGuiWindowFlags_NoMove);
    if (!filter_open_) return rect.low.x;
    push_path(editor, "Type");
    if (pressed(Key::Escape)) ImGui::CloseCurrentPopup();
    for (int i = 0; i < std::ssize(request_.filters); ++i) {
      const glm::vec2 corner = from_im(ImGui::GetCursorScreenPos());
      const bool picked = ImGui::Selectable(("##" + request_.filters[i].name).c_str(), i == filter_, 0, ImVec2(rect.width(), look.px(20)));
      const Rect row{corner, corner + glm::vec2(rect.width(), look.px(20))};
      register_widget(editor, request_.filters[i].name, row);
      put_text(editor, look.fonts.regular, look.theme.text, Rect{{row.low.x + look.px(6), row.low.y}, row.high}, request_.filters[i].name);
      if (picked) {
        filter_ = i;
        changed_ = true;
      }
    }
    pop_path(editor);
    ImGui::EndPopup();
    return rect.low.x;
  }

  void draw_replace(Editor& editor, const Rect& rect) {
    const Look& look = editor.look;
    const float low = rect.centre().y - look.px(14), high = rect.centre().y + look.px(14);
    put_icon(look.fonts.regular, look.theme.warn, Rect{{rect.low.x + look.px(14), low}, {rect.low.x + look.px(34), high}}, icon::kWarning);
    put_text(editor, look.fonts.regular, look.theme.text, Rect{{rect.low.x + look.px(42), low}, {rect.high.x - look.px(210), high}}, replace_->filename().string() + " is there already");
    float right = rect.high.x - look.px(12);
    const Path path = *replace_;
    if (button(editor, "Replace", {{right - look.px(88), low}, {right, high}}, {"", "Replace"})) return finish(editor, path);
    right -= look.px(96);
    if (button(editor, "Keep it", {{right - look.px(88), low}, {right, high}}, {"", "Keep it", ButtonStyle::Primary})) replace_.reset();
  }

  FileRequest request_;
  std::vector<Place> places_;
  Path folder_;
  std::unique_ptr<DirectoryReader> reader_;
  DirectoryContents contents_;
  std::vector<int> rows_;  // shown, as places in the contents
  std::string search_, name_, remark_, select_after_reading_;
  std::optional<std::string> new_folder_;
  std::optional<Path> replace_;
  SortBy by_ = SortBy::Name;
  Focus focus_ = Focus::List;
  int row_ = 0, place_ = 0, filter_ = 0, text_ = 0;
  bool falling_ = false, changed_ = true, reveal_ = false, refocus_ = true, row_moved_ = false, filter_open_ = false, focus_new_folder_ = false;
  bool text_was_empty_ = true;
  bool seen_ = false;       // the key that opened it does nothing in it
  bool had_error_ = false;  // keys belong to the message above
};

}  // namespace

void browse(Editor& editor, FileRequest request) {
  editor.open_dialog(std::make_unique<FileBrowser>(editor, std::move(request)));
  editor.touch();
}

}  // namespace limber::editor
