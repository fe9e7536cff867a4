// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/fuzzy_match.h"

#include <string>

#include <doctest/doctest.h>

using limber::editor::fuzzy_match;

namespace {

int score(const char* query, const char* text) {
  const auto match = fuzzy_match(query, text);
  REQUIRE(match);
  return match->score;
}

}  // namespace

TEST_CASE("fuzzy: letters begin words or follow one another, letters from the middle of words find nothing") {
  for (const char* query : {"fra", "FRAME", "fa", "all", "frall", "all frame", "a", "", "f a"})
    CHECK(fuzzy_match(query, "Frame all"));
  for (const char* query : {"rame", "fm", "lla", "framed", "frame all of it", "fx", "ml"})
    CHECK_FALSE(fuzzy_match(query, "Frame all"));
  CHECK(fuzzy_match("xray", "X-ray"));
  CHECK(fuzzy_match("tx", "Toggle X-ray"));
}

TEST_CASE("fuzzy: the matched letters are those of the query, in the text's order") {
  const auto match = fuzzy_match("all fr", "Frame all");
  REQUIRE(match);
  CHECK(match->letters == std::vector<std::size_t>{0, 1, 6, 7, 8});
  CHECK(fuzzy_match("mir", "Toggle X-mirror")->letters == std::vector<std::size_t>{9, 10, 11});
}

TEST_CASE("fuzzy: the beginning of the text stands before a later word, a run before scattered letters") {
  CHECK(score("mir", "Mirror pose") > score("mir", "Select mirrored bones"));
  CHECK(score("sel", "Select all") > score("sel", "Show every label"));
  CHECK(score("fa", "Frame all") > score("fa", "Frame the last of all"));
  CHECK(score("", "anything") == 0);
}

TEST_CASE("fuzzy: any bytes are taken, and long ones end") {
  std::string text, query;
  for (int i = 0; i < 400; ++i) text += static_cast<char>(i * 37), query += i % 2 ? 'a' : 'b';
  fuzzy_match(query, text);
  CHECK(fuzzy_match(std::string(60, 'a'), std::string(3000, 'a')));
  CHECK_FALSE(fuzzy_match(std::string(60, 'a') + "b", std::string(3000, 'a')));
}
