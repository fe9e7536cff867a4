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
  Remembered remembered;
  add_recent(remembered, "/a/one.limber", 10);
  add_recent(remembered, "/a/two.limber", 20);
  add_recent(remembered, "/a/one.limber", 30);
  remembered.folders["open"] = "/a";
  remembered.show_start = false;
  remembered.tour_step = 3;
  write_remembered(remembered, folder / "config/remembered.json");
  std::string warning;
  CHECK(read_remembered(folder / "config/remembered.json", warning) == remembered);
  CHECK(warning.empty());
  CHECK(remembered.recents.size() == 2);
  CHECK(remembered.recents[0].path == "/a/one.limber");
}

TEST_CASE("remembered: a damaged file is set aside with a message, and odd values are left out") {
  const TemporaryFolder folder;
  for (const char* text : {"", "{", "[]", "{\"schema\": \"other\"}", "\xff\xfe nothing"}) {
    std::ofstream(folder / "remembered.json") << text;
    std::string warning;
    CHECK(read_remembered(folder / "remembered.json", warning) == Remembered{});
    CHECK_FALSE(warning.empty());
    CHECK_FALSE(std::filesystem::exists(folder / "remembered.json"));
    CHECK(std::filesystem::exists(folder / "remembered.json.damaged"));
  }
  std::ofstream(folder / "remembered.json")
      << R"({"schema": "limber-remembered/1", "recent": [3, {"path": 4}, {"path": "not/absolute"}, {"path": "/ok"}],
    "folders": {"open": 7}, "show_start": "yes", "tour_step": 1.5})";
  std::string warning;
  const Remembered remembered = read_remembered(folder / "remembered.json", warning);
  CHECK(warning.empty());
  REQUIRE(remembered.recents.size() == 1);
  CHECK(remembered.recents[0].path == "/ok");
  CHECK(remembered.show_start);
  CHECK(remembered.tour_step == 0);
}

TEST_CASE("remembered: the tour has no step before its first") {
  const TemporaryFolder folder;
  for (const auto& [kept, step] : {std::pair{"-4", 0}, {"4", 4}}) {
    std::ofstream(folder / "remembered.json") << R"({"schema": "limber-remembered/1", "tour_step": )" << kept << "}";
    std::string warning;
    CHECK(read_remembered(folder / "remembered.json", warning).tour_step == step);
  }
}
