// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads a folder's entries in a thread of its own, so that a slow disk or a hundred thousand files do not block the
// editor. Also finds the entries that a file dialog shows (by file type and name), and sorts them by a column of its
// list.
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
  std::uint64_t size = 0;  // size of the file, bytes
  std::int64_t time = 0;   // time of the last change, s since 1970

  bool operator==(const DirectoryEntry&) const = default;
};

struct DirectoryContents {
  std::vector<DirectoryEntry> entries;
  bool holds_dicom = false;
  bool complete = false;
  std::string failure;  // why the folder cannot be read, one line; empty: no failure
};

class DirectoryReader {
 public:
  // Starts to read the folder. `on_change` is called from the reader's thread whenever more entries have been read.
  explicit DirectoryReader(Path folder, std::function<void()> on_change = {});
  ~DirectoryReader();  // tells the reader's thread to stop, but does not wait for it, because a disk may hang
  DirectoryReader(const DirectoryReader&) = delete;
  DirectoryReader& operator=(const DirectoryReader&) = delete;

  const Path& folder() const { return folder_; }
  bool wait(double seconds) const;  // waits until the folder has been read; returns false if that takes longer
  // Returns the contents read so far, or nothing if they have not changed since the last call.
  std::optional<DirectoryContents> news();

 private:
  struct Board;
  static void read(const std::shared_ptr<Board>& board, const Path& folder);
  Path folder_;
  std::shared_ptr<Board> board_;
};

// A type of files, such as "Volumes", recognized by the endings of their names. With no endings, it includes all files.
struct FileFilter {
  std::string name;
  std::vector<std::string> ends;  // endings of file names, in lower case, with the dot: ".mha"
};
bool matches(const FileFilter& filter, const std::string& name);

enum class SortBy { Name, Size, Time };
struct DirectoryView {
  const FileFilter* filter = nullptr;  // type of the files to show, in addition to all folders; null: all files
  std::string search;                  // text that shown names must contain, ignoring case
  bool hidden = false;
  bool folders_only = false;
  SortBy by = SortBy::Name;
  bool falling = false;
};
// Returns the indices of the entries to show, in the order to show them: folders first. Numbers in names are sorted by
// their value ("scan 9" before "scan 10").
std::vector<int> shown_entries(const std::vector<DirectoryEntry>& entries, const DirectoryView& view);
bool natural_less(const std::string& a, const std::string& b);

std::string size_text(std::uint64_t bytes);  // returns a file size as text: "1.4 MB"
// Returns a time as text: "today 10:42", "yesterday", "18 Nov", "18 Nov 2024".
std::string time_text(std::int64_t time, std::int64_t now);

}  // namespace limber::editor
