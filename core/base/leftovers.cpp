// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/leftovers.h"

#include <atomic>
#include <cstdlib>
#include <exception>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace limber {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestNote = 8192;

// Returns the folder of the notes that name unfinished files: $XDG_STATE_HOME/limber/unfinished, else
// $HOME/.local/state/limber/unfinished. Empty when neither variable is set.
Path notes_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  if (state && *state == '/') return Path(state) / "limber" / "unfinished";
  if (home && *home == '/') return Path(home) / ".local/state" / "limber" / "unfinished";
  return {};
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
  struct stat status {};
  const bool is_there = ::lstat(path.c_str(), &status) == 0;
  return is_there && status.st_uid == ::geteuid() && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
}

std::string read_note(int descriptor) {
  std::string text(kLongestNote, '\0');
  const ssize_t got = ::pread(descriptor, text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(got > 0 ? got : 0));
  return text;
}

// Removes a note and the unfinished file that the note names, unless a living process holds the note's lock. A note
// that does not end with a line feed is incomplete; then only the note is removed.
void clear(const Path& note) {
  const int file = ::open(note.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return;
  if (::flock(file, LOCK_EX | LOCK_NB) == 0) {
    std::string text = read_note(file);
    if (text.ends_with('\n')) {
      text.pop_back();
      if (text.starts_with('/') && named_as_ours(text) && belongs_to_user(text)) remove_all_of(text);
    }
    ::unlink(note.c_str());
  }
  ::close(file);
}

}  // namespace

Unfinished::Unfinished(const Path& path) : path_(fs::absolute(path)) {
  static std::atomic<int> count = 0;
  const Path folder = notes_folder();
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  note_ = folder / (std::to_string(::getpid()) + "-" + std::to_string(++count));
  // The note is locked under another name first, then renamed. A program that starts meanwhile would take an unlocked
  // note for that of a dead process.
  const Path fresh = note_.string() + ".new";
  descriptor_ = ::open(fresh.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
  const std::string text = path_.string() + "\n";
  const bool noted = descriptor_ >= 0 && text.size() <= kLongestNote && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 &&
                     ::write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                     ::rename(fresh.c_str(), note_.c_str()) == 0;
  if (!noted) {
    if (descriptor_ >= 0) ::unlink(fresh.c_str());
    note_.clear();
  }
}

Unfinished::~Unfinished() {
  remove_all_of(path_);
  if (!note_.empty()) ::unlink(note_.c_str());
  if (descriptor_ >= 0) ::close(descriptor_);
}

Path temporary_name(const Path& path) {
  const Path folder = path.has_parent_path() ? path.parent_path() : Path(".");
  return folder / (".limber-" + std::to_string(::getpid()) + "-" + path.filename().string());
}

void remove_leftovers() try {
  const Path folder = notes_folder();
  std::error_code error;
  if (folder.empty()) return;
  for (const auto& entry : fs::directory_iterator(folder, error)) clear(entry.path());
} catch (const std::exception&) {  // the next start of the program tries again to remove the files
}

}  // namespace limber
