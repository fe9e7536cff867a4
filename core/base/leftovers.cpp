// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/leftovers.h"

#include <atomic>
#include <exception>
#include <system_error>

#include "core/platform/desktop.h"
#include "core/platform/process.h"

namespace limber {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestNote = 8192;

// Returns the folder of the notes that name unfinished files; empty when the user has no folder for such files.
Path notes_folder() {
  const Path state = user_folder(UserFolder::State);
  return state.empty() ? Path() : state / "limber" / "unfinished";
}

bool named_as_ours(const Path& path) {
  const std::string name = path.filename().string();
  const bool scratch = name.starts_with("limber-") && name.size() == std::string("limber-XXXXXX").size();
  return name.starts_with(".limber-") || scratch || name.ends_with("edits.new");
}

void remove_all_of(const Path& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);  // if `path` is a symbolic link, removes the link, not its target
  fs::remove(path.string() + "-journal", ignored);
}

bool belongs_to_user(const Path& path) {
  const auto status = status_of_link(path);
  return status && status->is_own && (status->is_regular || status->is_folder);
}

std::string read_note(const OpenFile& file) {
  std::string text(kLongestNote, '\0');
  text.resize(file.read_at(0, text.data(), text.size()));
  return text;
}

// Removes a note and the unfinished file that the note names, unless a living process holds the note's lock. A note
// that does not end with a line feed is incomplete; then only the note is removed.
void clear(const Path& note) {
  std::error_code error;
  OpenFile file(note, Opening::Read, error, {.follows_links = false});
  if (error || file.lock() != OpenFile::Lock::Taken) return;
  std::string text = read_note(file);
  if (text.ends_with('\n')) {
    text.pop_back();
    if (Path(text).is_absolute() && named_as_ours(text) && belongs_to_user(text)) remove_all_of(text);
  }
  fs::remove(note, error);
}

}  // namespace

Unfinished::Unfinished(const Path& path) : path_(fs::absolute(path)) {
  static std::atomic<int> count = 0;
  const Path folder = notes_folder();
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  note_ = folder / (std::to_string(process_id()) + "-" + std::to_string(++count));
  // The note is locked under another name first, then renamed. A program that starts meanwhile would take an unlocked
  // note for that of a dead process.
  const Path fresh = note_.string() + ".new";
  locked_ = OpenFile(fresh, Opening::Overwrite, error, {.is_private = true, .follows_links = false});
  const std::string text = path_.string() + "\n";
  const bool noted =
      !error && text.size() <= kLongestNote && locked_.lock() == OpenFile::Lock::Taken && !locked_.write(text);
  if (noted) fs::rename(fresh, note_, error);
  if (noted && !error) return;
  if (locked_.is_open()) fs::remove(fresh, error);
  note_.clear();
}

Unfinished::~Unfinished() {
  remove_all_of(path_);
  std::error_code ignored;
  if (!note_.empty()) fs::remove(note_, ignored);
}

Path temporary_name(const Path& path) {
  const Path folder = path.has_parent_path() ? path.parent_path() : Path(".");
  return folder / (".limber-" + std::to_string(process_id()) + "-" + path.filename().string());
}

void remove_leftovers() try {
  const Path folder = notes_folder();
  std::error_code error;
  if (folder.empty()) return;
  for (const auto& entry : fs::directory_iterator(folder, error)) clear(entry.path());
} catch (const std::exception&) {  // the next start of the program tries again to remove the files
}

}  // namespace limber
