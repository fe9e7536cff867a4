// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/recent_files.h"

#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;
using namespace limber::editor;

TEST_CASE("remembered: what is written is read back") {
  const TemporaryFolder folder;
  RecentFiles recent_files;
  add_recent(recent_files, "/a/one.limber", 10);
  add_recent(recent_files, "/a/two.limber", 20);
  add_recent(recent_files, "/a/one.limber", 30);
  recent_files.folders["open"] = "/a";
  recent_files.show_start = false;
  recent_files.tour_step = 3;
  write_recent_files(recent_files, folder / "config/remembered.json");
  std::string warning;
  CHECK(read_recent_files(folder / "config/remembered.json", warning) == recent_files);
  CHECK(warning.empty());
  CHECK(recent_files.recents.size() == 2);
  CHECK(recent_files.recents[0].path == "/a/one.limber");
}

TEST_CASE("remembered: a damaged file is set aside with a message, and odd values are left out") {
  const TemporaryFolder folder;
  for (const char* text : {"", "{", "[]", "{\"schema\": \"other\"}", "\xff\xfe nothing"}) {
    std::ofstream(folder / "remembered.json") << text;
    std::string warning;
    CHECK(read_recent_files(folder / "remembered.json", warning) == RecentFiles{});
    CHECK_FALSE(warning.empty());
    CHECK_FALSE(std::filesystem::exists(folder / "remembered.json"));
    CHECK(std::filesystem::exists(folder / "remembered.json.damaged"));
  }
  std::ofstream(folder / "remembered.json")
      << R"({"schema": "limber-remembered/1", "recent": [3, {"path": 4}, {"path": "not/absolute"}, {"path": "/ok"}],
    "folders": {"open": 7}, "show_start": "yes", "tour_step": 1.5})";
  std::string warning;
  const RecentFiles recent_files = read_recent_files(folder / "remembered.json", warning);
  CHECK(warning.empty());
  REQUIRE(recent_files.recents.size() == 1);
  CHECK(recent_files.recents[0].path == "/ok");
  CHECK(recent_files.show_start);
  CHECK(recent_files.tour_step == 0);
}

TEST_CASE("remembered: the tour has no step before its first") {
  const TemporaryFolder folder;
  for (const auto& [kept, step] : {std::pair{"-4", 0}, {"4", 4}}) {
    std::ofstream(folder / "remembered.json") << R"({"schema": "limber-remembered/1", "tour_step": )" << kept << "}";
    std::string warning;
    CHECK(read_recent_files(folder / "remembered.json", warning).tour_step == step);
  }
}
