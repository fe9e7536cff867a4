// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/directory_listing.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <ctime>
#include <utility>

#include "core/platform/file_system.h"
#include "core/platform/local_time.h"
#include "core/volume_io/dicom.h"

namespace limber::editor {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto kPublishEvery = std::chrono::milliseconds(50);
constexpr int kDicomTries = 16;  // upper limit on the files of a folder that are opened to check whether they are DICOM

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Returns true if the file's name is one that a scanner gives to DICOM images: a name without an extension, with digits
// as the extension, or with the extension .dcm or .ima.
bool may_be_dicom(const std::string& name) {
  const std::string end = lower(Path(name).extension().string());
  const bool number = end.size() > 1 && std::all_of(end.begin() + 1, end.end(), [](char c) {
                        return std::isdigit(static_cast<unsigned char>(c)) || c == '.';
                      });
  return end.empty() || end == ".dcm" || end == ".ima" || number;
}

DirectoryEntry entry_of(const fs::directory_entry& found) {
  DirectoryEntry entry{found.path().filename().string()};
  if (const auto status = status_of_file(found.path())) {
    entry.folder = status->is_folder;
    entry.size = entry.folder ? 0 : static_cast<std::uint64_t>(status->size);
    entry.time = status->seconds;
  }
  return entry;
}

}  // namespace

struct DirectoryReader::Board {
  std::mutex mutex;
  std::condition_variable changed;
  DirectoryContents contents;
  bool news = false, stop = false;
  std::function<void()> on_change;

  // Makes the entries read so far available to DirectoryReader::news(). Returns false if the DirectoryReader has been
  // destroyed, so that its thread stops.
  bool publish(const DirectoryContents& now) {
    const std::lock_guard lock(mutex);
    if (stop) return false;
    contents = now;
    news = true;
    changed.notify_all();
    if (on_change) on_change();
    return true;
  }
};

void DirectoryReader::read(const std::shared_ptr<Board>& board, const Path& folder) {
  DirectoryContents contents;
  std::error_code error;
  int dicom_tries = 0;
  auto published = Clock::now();
  fs::directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    contents.entries.push_back(entry_of(*entry));
    const DirectoryEntry& added = contents.entries.back();
    if (!contents.holds_dicom && !added.folder && added.size > 132 && dicom_tries < kDicomTries &&
        may_be_dicom(added.name)) {
      ++dicom_tries;
      contents.holds_dicom = is_dicom_file(entry->path());
    }
    if (Clock::now() - published < kPublishEvery) continue;
    if (!board->publish(contents)) return;
    published = Clock::now();
  }
  if (error)
    contents.failure = error == std::errc::permission_denied ? "You have no permission to read this folder"
                       : error == std::errc::no_such_file_or_directory
                           ? "This folder does not exist"
                           : "This folder cannot be read: " + error.message();
  contents.complete = true;
  board->publish(contents);
}

DirectoryReader::DirectoryReader(Path folder, std::function<void()> on_change)
    : folder_(std::move(folder)),
      board_(std::make_shared<Board>()) {
  board_->on_change = std::move(on_change);
  std::thread([board = board_, path = folder_] { read(board, path); }).detach();
}

DirectoryReader::~DirectoryReader() {
  const std::lock_guard lock(board_->mutex);
  board_->stop = true;
}

bool DirectoryReader::wait(double seconds) const {
  std::unique_lock lock(board_->mutex);
  return board_->changed.wait_for(lock, std::chrono::duration<double>(seconds),
                                  [&] { return board_->contents.complete; });
}

std::optional<DirectoryContents> DirectoryReader::news() {
  const std::lock_guard lock(board_->mutex);
  if (!std::exchange(board_->news, false)) return std::nullopt;
  return board_->contents;
}

bool matches(const FileFilter& filter, const std::string& name) {
  const std::string lowered = lower(name);
  return filter.ends.empty() || std::any_of(filter.ends.begin(), filter.ends.end(),
                                            [&](const std::string& end) { return lowered.ends_with(end); });
}

bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      while (i < a.size() && a[i] == '0') ++i;
      while (j < b.size() && b[j] == '0') ++j;
      std::size_t end_a = i, end_b = j;
      while (end_a < a.size() && digit(a[end_a])) ++end_a;
      while (end_b < b.size() && digit(b[end_b])) ++end_b;
      if (end_a - i != end_b - j) return end_a - i < end_b - j;
      if (const int order = a.compare(i, end_a - i, b, j, end_b - j); order != 0) return order < 0;
      i = end_a;
      j = end_b;
      continue;
    }
    const int x = std::tolower(static_cast<unsigned char>(a[i])), y = std::tolower(static_cast<unsigned char>(b[j]));
    if (x != y) return x < y;
    ++i;
    ++j;
  }
  if ((i < a.size()) != (j < b.size())) return i >= a.size();
  return a < b;  // the names are equal except for case and leading zeros
}

std::vector<int> shown_entries(const std::vector<DirectoryEntry>& entries, const DirectoryView& view) {
  const std::string search = lower(view.search);
  std::vector<int> shown;
  for (int i = 0; i < std::ssize(entries); ++i) {
    const DirectoryEntry& entry = entries[i];
    if (!view.hidden && entry.name.starts_with(".")) continue;
    if (!entry.folder && (view.folders_only || (view.filter && !matches(*view.filter, entry.name)))) continue;
    if (!search.empty() && lower(entry.name).find(search) == std::string::npos) continue;
    shown.push_back(i);
  }
  const auto before = [&](int i, int j) {
    const DirectoryEntry &a = entries[i], &b = entries[j];
    if (a.folder != b.folder) return a.folder;
    const bool swap = view.falling;
    const DirectoryEntry &first = swap ? b : a, &second = swap ? a : b;
    if (view.by == SortBy::Size && first.size != second.size) return first.size < second.size;
    if (view.by == SortBy::Time && first.time != second.time) return first.time < second.time;
    return natural_less(first.name, second.name);
  };
  std::sort(shown.begin(), shown.end(), before);
  return shown;
}

std::string size_text(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {"B", "KB", "MB", "GB", "TB"};
  double number = static_cast<double>(bytes);
  int unit = 0;
  for (; number >= 1000 && unit < 4; ++unit) number /= 1000;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 || number >= 100 ? "%.0f %s" : "%.1f %s", number, kUnits[unit]);
  return text;
}

std::string time_text(std::int64_t time, std::int64_t now) {
  constexpr std::int64_t kDay = 24 * 3600;
  const std::tm then = local_time(time), today = local_time(now), yesterday = local_time(now - kDay);
  const auto same_day = [](const std::tm& a, const std::tm& b) {
    return a.tm_year == b.tm_year && a.tm_yday == b.tm_yday;
  };
  char text[40];
  if (same_day(then, today)) std::strftime(text, sizeof text, "today %H:%M", &then);
  else if (same_day(then, yesterday)) return "yesterday";
  else std::strftime(text, sizeof text, then.tm_year == today.tm_year ? "%-d %b" : "%-d %b %Y", &then);
  return text;
}

}  // namespace limber::editor
