// SPDX-License-Identifier: AGPL-3.0-or-later
// A folder's entries, read in a thread of their own, so that a slow disk or a hundred thousand files stop nobody; and
// what a file dialog shows of them: filtered by type and name, sorted by a column.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/file.h"

namespace limber::editor {

struct DirectoryEntry {
  std::string name;
  bool folder = false;
  std::uint64_t size = 0;  // bytes
  std::int64_t time = 0;   // of the last change, s since 1970

  bool operator==(const DirectoryEntry&) const = default;
};

struct DirectoryContents {
  std::vector<DirectoryEntry> entries;
  bool holds_dicom = false;
  bool complete = false;
  std::string failure;  // why it cannot be read, one line
};

class DirectoryReader {
 public:
  // `on_change` is called from the reader's thread.
  explicit DirectoryReader(Path folder, std::function<void()> on_change = {});
  ~DirectoryReader();  // does not wait for a disk that hangs
  DirectoryReader(const DirectoryReader&) = delete;
  DirectoryReader& operator=(const DirectoryReader&) = delete;

  const Path& folder() const { return folder_; }
  bool wait(double seconds) const;  // until it is complete; false when it is not
  // What is there by now; nothing when that has not changed since the last call.
  std::optional<DirectoryContents> news();

 private:
  struct Board;
  static void read(const std::shared_ptr<Board>& board, const Path& folder);
  Path folder_;
  std::shared_ptr<Board> board_;
};

// A kind of files: "Volumes" by the ends of their names; no ends: all files.
struct FileFilter {
  std::string name;
  std::vector<std::string> ends;  // lower case, with the dot
};
bool matches(const FileFilter& filter, const std::string& name);

enum class SortBy { Name, Size, Time };
struct DirectoryView {
  const FileFilter* filter = nullptr;  // of files; folders are always shown
  std::string search;                  // what names must hold, in any case of letters
  bool hidden = false;
  bool folders_only = false;
  SortBy by = SortBy::Name;
  bool falling = false;
};
// Places in `entries` of what is shown: folders first, names in the order a reader expects ("scan 9" before "scan 10").
std::vector<int> shown_entries(const std::vector<DirectoryEntry>& entries, const DirectoryView& view);
bool natural_less(const std::string& a, const std::string& b);

std::string size_text(std::uint64_t bytes);                  // "1.4 MB"
std::string time_text(std::int64_t time, std::int64_t now);  // "today 10:42", "yesterday", "18 Nov", "18 Nov 2024"

}  // namespace limber::editor
