// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/directory_listing.h"

#include <fstream>

#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;
using namespace limber::editor;

namespace {

std::vector<std::string> names(const std::vector<DirectoryEntry>& entries, const DirectoryView& view) {
  std::vector<std::string> names;
  for (const int i : shown_entries(entries, view)) names.push_back(entries[i].name);
  return names;
}

using Names = std::vector<std::string>;

const std::vector<DirectoryEntry> kEntries = {{"scan 10.nrrd", false, 5, 30}, {"scan 9.nrrd", false, 70, 20},
                                              {"Zebra", true, 0, 5},          {".hidden", false, 1, 1},
                                              {"notes.txt", false, 9, 40},    {"apes", true, 0, 6}};

}  // namespace

TEST_CASE("directory: folders come first, numbers in names count as numbers, and hidden files stay hidden") {
  CHECK(names(kEntries, {}) == Names{"apes", "Zebra", "notes.txt", "scan 9.nrrd", "scan 10.nrrd"});
  CHECK(names(kEntries, {.hidden = true}).size() == 6);
  CHECK(natural_less("a2", "a10"));
  CHECK_FALSE(natural_less("a10", "a2"));
  CHECK(natural_less("a", "B"));
  CHECK_FALSE(natural_less("same", "same"));
}

TEST_CASE("directory: a list is filtered by type and name, and sorted by size and time") {
  const FileFilter volumes{"Volumes", {".nrrd"}};
  CHECK(names(kEntries, {.filter = &volumes}) == Names{"apes", "Zebra", "scan 9.nrrd", "scan 10.nrrd"});
  CHECK(names(kEntries, {.search = "SCAN 1"}) == Names{"scan 10.nrrd"});
  CHECK(names(kEntries, {.folders_only = true}) == Names{"apes", "Zebra"});
  CHECK(names(kEntries, {.filter = &volumes, .by = SortBy::Size, .falling = true}) ==
        Names{"Zebra", "apes", "scan 9.nrrd", "scan 10.nrrd"});
  CHECK(names(kEntries, {.filter = &volumes, .by = SortBy::Time})[2] == "scan 9.nrrd");
}

TEST_CASE("directory: twenty thousand files are read beside the editor, and their order is the same each time") {
  const TemporaryFolder folder;
  for (int i = 0; i < 20'000; ++i) std::ofstream(folder / ("file" + std::to_string(i)));
  DirectoryReader reader(folder.path());
  REQUIRE(reader.wait(60));
  const auto contents = reader.news();
  REQUIRE(contents);
  CHECK(contents->entries.size() == 20'000);
  CHECK_FALSE(reader.news());
  const auto shown = names(contents->entries, {});
  CHECK(shown.front() == "file0");
  CHECK(shown.back() == "file19999");
}

TEST_CASE("directory: what cannot be read says so, and images without an end of name are seen to be DICOM") {
  const TemporaryFolder folder;
  DirectoryReader missing(folder / "missing");
  REQUIRE(missing.wait(10));
  CHECK(missing.news()->failure == "This folder does not exist");
  std::ofstream(folder / "IM0001") << std::string(128, '\0') << "DICM and more";
  DirectoryReader dicom(folder.path());
  REQUIRE(dicom.wait(10));
  CHECK(dicom.news()->holds_dicom);
}

TEST_CASE("directory: sizes and times read as people say them") {
  CHECK(size_text(0) == "0 B");
  CHECK(size_text(999) == "999 B");
  CHECK(size_text(1'400'000) == "1.4 MB");
  CHECK(size_text(235'000'000'000) == "235 GB");
  constexpr std::int64_t kDay = 24 * 3600, kNow = 1'700'000'000;
  CHECK(time_text(kNow, kNow).starts_with("today "));
  CHECK(time_text(kNow - kDay, kNow) == "yesterday");
  CHECK(time_text(kNow - 3 * kDay, kNow).ends_with("Nov"));
  CHECK(time_text(kNow - 400 * kDay, kNow).ends_with("2022"));
}
