// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <utility>

#include <imgui_internal.h>

#include "core/base/named_files.h"
#include "core/platform/desktop.h"
#include "core/volume_io/volume_files.h"
#include "editor/context/context.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/platform_window.h"
#include "editor/context/recent_files.h"
#include "editor/context/user_folders.h"
#include "editor/file_browser/file_browser_dialog.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace fs = std::filesystem;

namespace {

constexpr double kFirstWait = 0.08;  // longest wait for a folder's entries, s; most folders are read by then
constexpr int kPage = 12;            // number of rows by which PageUp and PageDown move

bool pressed(Key key, bool repeat = false) { return ImGui::IsKeyPressed(static_cast<int>(key), repeat); }
bool pressed_return() { return pressed(Key::Return) || pressed(Key::NumEnter); }

// Returns true, and warns the user, if writing to this path would overwrite a file from which the project was read.
bool refuses_to_write(Context& context, const Path& path, bool as_project) {
  std::vector<NamedFile> inputs = context.project->inputs, outputs;
  if (!as_project && !context.project->path.empty()) inputs.push_back({"the project", context.project->path});
  for (const Path& file : files_written_as(path)) outputs.push_back({"the file to write", file});
  try {
    check_apart(inputs, outputs);
    return false;
  } catch (const UsageError& error) {
    const ErrorMessage message = parts_of(error.what());
    context.messages->warn(message.what, message.where + ": " + message.what_to_do);
    return true;
  }
}

}  // namespace

FileBrowser::FileBrowser(Context& context, FileRequest request)
    : request_(std::move(request)),
      places_(places_of(context)),
      name_(request_.name) {
  if (request_.kind != FileRequest::Kind::OpenFolder) request_.filters.push_back({"All files", {}});
  const auto last = context.recent_files->folders.find(request_.purpose);
  Path begin = last != context.recent_files->folders.end() ? last->second : request_.folder;
  if (begin.empty() || !is_folder(begin))
    begin = context.project->path.empty() ? Path() : context.project->path.parent_path();
  if (begin.empty() || !is_folder(begin)) begin = home_folder();
  go_to(context, begin);
}

void FileBrowser::escape(Context& context) {
  if (replace_) return replace_.reset();
  if (new_folder_) return new_folder_.reset();
  if (filter_open_) return;
  if (!search_.empty() && !saving()) {
    search_.clear();
    ++text_;
    refocus_ = changed_ = true;
    return;
  }
  leave(context);
}

void FileBrowser::go_to(Context& context, const Path& folder) {
  const std::string came_from = folder_.parent_path() == folder ? folder_.filename().string() : "";
  folder_ = folder.lexically_normal();
  if (folder_ != "/" && !folder_.has_filename()) folder_ = folder_.parent_path();
  contents_ = {};
  rows_.clear();
  reader_ = std::make_unique<DirectoryReader>(folder_, [&host = *context.host] { host.wake(); });
  reader_->wait(kFirstWait);
  if (!saving()) search_.clear();
  ++text_;
  select_after_reading_ = came_from;
  row_ = 0;
  refocus_ = changed_ = true;
  context.ui->touch();
}

void FileBrowser::follow(Context& context) {
  if (auto news = reader_->news()) {
    const std::string at = chosen() ? chosen()->name : select_after_reading_;
    contents_ = std::move(*news);
    arrange_rows(context);
    select(at);
  } else if (changed_) {
    const std::string at = chosen() ? chosen()->name : select_after_reading_;
    arrange_rows(context);
    select(at);
  }
  if (!contents_.complete) context.ui->wake_at(context.ui->now);
}

void FileBrowser::arrange_rows(Context& context) {
  changed_ = false;
  DirectoryView view{.search = saving()          ? ""
                               : path_is_typed() ? ""
                                                 : search_,
                     .hidden = context.recent_files->hidden_files,
                     .folders_only = folders_only(),
                     .by = by_,
                     .falling = falling_};
  if (!folders_only()) view.filter = &request_.filters[filter_];
  rows_ = shown_entries(contents_.entries, view);
  row_ = std::clamp(row_, 0, std::max(0, static_cast<int>(rows_.size()) - 1));
}

void FileBrowser::select(const std::string& name) {
  if (name.empty()) return;
  for (int i = 0; i < std::ssize(rows_); ++i)
    if (contents_.entries[rows_[i]].name == name) {
      row_ = i;
      reveal_ = true;
      select_after_reading_.clear();
      return;
    }
}

void FileBrowser::take_keys(Context& context) {
  if (!seen_ || had_error_ || replace_ || new_folder_ || filter_open_) return;
  const bool alt = context.ui->input.down(Key::Alt), ctrl = context.ui->input.down(Key::Ctrl);
  if (ctrl && pressed(Key::H)) toggle_hidden(context);
  if (pressed(Key::Tab)) {
    focus_ = focus_ == Focus::List ? Focus::Places : Focus::List;
    refocus_ = focus_ == Focus::List;
    if (focus_ == Focus::Places) ImGui::ClearActiveID();
  }
  if ((alt && pressed(Key::Up)) || (pressed(Key::Backspace) && text_was_empty_)) return go_up(context);
  text_was_empty_ = saving() ? name_.empty() : search_.empty();
  if (alt) return;
  if (focus_ == Focus::Places) {
    const int last = static_cast<int>(places_.size()) - 1;
    if (pressed(Key::Down, true)) place_ = std::min(place_ + 1, last);
    if (pressed(Key::Up, true)) place_ = std::max(place_ - 1, 0);
    if (pressed_return() && place_ <= last) {
      focus_ = Focus::List;
      go_to(context, places_[place_].path);
    }
    return;
  }
  move_row(context);
  if (pressed_return()) accept(context);
}

void FileBrowser::move_row(Context&) {
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

void FileBrowser::set_name(const std::string& name) {
  name_ = name;
  ++text_;
  refocus_ = true;
}

// Replaces the ending of the proposed file name by the first ending of a file type. Does nothing if the name has an
// ending that belongs to none of the dialog's file types.
void FileBrowser::take_ending(const FileFilter& filter) {
  if (filter.ends.empty()) return;
  std::size_t longest = 0;
  for (const FileFilter& one : request_.filters)
    for (const std::string& end : one.ends)
      if (name_.ends_with(end)) longest = std::max(longest, end.size());
  if (longest > 0) set_name(name_.substr(0, name_.size() - longest) + filter.ends.front());
}

void FileBrowser::go_up(Context& context) {
  if (folder_.has_parent_path() && folder_ != folder_.parent_path()) go_to(context, folder_.parent_path());
}

void FileBrowser::toggle_hidden(Context& context) {
  context.recent_files->hidden_files = !context.recent_files->hidden_files;
  changed_ = true;
}

void FileBrowser::leave(Context& context) {
  const auto left = request_.left;
  context.dialogs->close();
  if (left) left(context);
}

void FileBrowser::finish(Context& context, const Path& path) {
  const Path folder = is_folder(path) && folders_only() ? path : path.parent_path();
  context.recent_files->folders[request_.purpose] = folder;
  add_recent_folder(context.recent_files, folder);
  const auto act = request_.chosen;
  context.dialogs->close();
  context.ui->touch();
  attempt(context, request_.title, [&](Context& c) { act(c, path); });
}

void FileBrowser::accept(Context& context) {
  if (!saving() && path_is_typed()) return accept_typed(context);
  const DirectoryEntry* entry = chosen();
  if (saving()) {
    if (row_moved_ && entry && entry->folder) return enter(context, *entry);
    return accept_name(context);
  }
  if (!entry) return;
  if (entry->folder) return enter(context, *entry);
  finish(context, folder_ / entry->name);
}

void FileBrowser::accept_typed(Context& context) {
  const Path typed = search_.starts_with("~") ? home_folder() / Path(search_.substr(1)).relative_path() : Path(search_);
  std::error_code error;
  if (is_folder(typed)) return go_to(context, typed);
  if (!folders_only() && fs::exists(typed, error)) return finish(context, typed);
  remark_ = "There is no such file";
}

void FileBrowser::accept_name(Context& context) {
  if (name_.empty()) return;
  Path path = name_.starts_with("~") ? home_folder() / Path(name_.substr(1)).relative_path() : Path(name_);
  if (path.is_relative()) path = folder_ / path;
  path = path.lexically_normal();
  if (is_folder(path)) {
    set_name(request_.name);
    return go_to(context, path);
  }
  const FileFilter& filter = request_.filters[filter_];
  const auto is_known = [&](const FileFilter& one) {
    return !one.ends.empty() && matches(one, path.filename().string());
  };
  if (!filter.ends.empty() && std::none_of(request_.filters.begin(), request_.filters.end(), is_known))
    path += filter.ends.front();
  if (!is_folder(path.parent_path())) return void(remark_ = "There is no folder " + short_path(path.parent_path()));
  if (refuses_to_write(context, path, request_.purpose == "project")) return;
  std::error_code error;
  if (fs::exists(path, error)) return void(replace_ = path);
  finish(context, path);
}

void FileBrowser::enter(Context& context, const DirectoryEntry& entry) {
  row_moved_ = false;
  go_to(context, folder_ / entry.name);
}

void FileBrowser::make_folder(Context& context) {
  const Path path = folder_ / *new_folder_;
  if (new_folder_->empty() || new_folder_->find('/') != std::string::npos)
    return void(remark_ = "A folder's name must not be empty or contain /");
  std::error_code error;
  if (!fs::create_directory(path, error))
    return void(remark_ = error ? "The folder cannot be created: " + error.message()
                                : "There already is a file or folder of this name");
  new_folder_.reset();
  go_to(context, path);
}

void FileBrowser::open_row(Context& context, int index) {
  row_ = index;
  const DirectoryEntry entry = contents_.entries[rows_[index]];
  if (entry.folder) return enter(context, entry);
  saving() ? accept_name(context) : finish(context, folder_ / entry.name);
}

void FileBrowser::finish_folder(Context& context) {
  context.recent_files->folders[request_.purpose] = folder_;
  add_recent_folder(context.recent_files, folder_);
  const auto act = request_.chosen;
  context.dialogs->close();
  context.ui->touch();
  attempt(context, request_.title, [act, path = folder_](Context& c) { act(c, path); });
}

void browse(Context& context, FileRequest request) {
  context.dialogs->open(std::make_unique<FileBrowser>(context, std::move(request)));
  context.ui->touch();
}

}  // namespace limber::editor
