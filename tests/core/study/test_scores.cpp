// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/scores.h"

#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/study/agreement.h"
#include "tests/support/program.h"

using namespace limber;

namespace {

// Makes a table from one row per rater, as papers print it; 0 means no score.
ScoreTable table_of(const std::vector<std::vector<int>>& raters) {
  ScoreTable scores(raters.front().size());
  for (const auto& rater : raters)
    for (std::size_t i = 0; i < rater.size(); ++i)
      scores[i].push_back(rater[i] ? std::optional(rater[i]) : std::nullopt);
  return scores;
}

const std::string kHead = "study,rater,order,picture,score,remark\r\n";

}  // namespace

TEST_CASE("scores: Krippendorff's alpha of his own example, with four raters and missing scores, is 0.815") {
  // Data of Krippendorff 2011, Computing Krippendorff's alpha-reliability, section C, where the ordinal alpha is 0.815.
  const ScoreTable scores = table_of({{1, 2, 3, 3, 2, 1, 4, 1, 2, 0, 0, 0},
                                      {1, 2, 3, 3, 2, 2, 4, 1, 2, 5, 0, 3},
                                      {0, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, 0},
                                      {1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, 0}});
  CHECK(krippendorff_alpha(scores).value() == doctest::Approx(0.815).epsilon(0.0005));
  CHECK(krippendorff_alpha(table_of({{1, 2, 5}, {1, 2, 5}})) == doctest::Approx(1));
  CHECK_FALSE(krippendorff_alpha(table_of({{3, 3}, {3, 3}})));
  CHECK_FALSE(krippendorff_alpha(table_of({{1, 2, 0}, {0, 0, 3}})));
  CHECK_FALSE(krippendorff_alpha({}));
}

TEST_CASE("scores: Cohen's kappa with quadratic weights is as reckoned by hand") {
  // The squared differences sum to 0 + 1 + 0 + 1 + 4 = 6. By chance it would be the sum over all 25 pairs of {1, 2, 3,
  // 4, 5} with {1, 3, 3, 5, 3}, divided by 5: 28 for score 1, then 13, 8, 13 and 28, together 90 / 5 = 18.
  const ScoreTable scores = table_of({{1, 2, 3, 4, 5, 0}, {1, 3, 3, 5, 3, 2}});
  CHECK(weighted_kappa(scores, 0, 1) == doctest::Approx(1 - 6.0 / 18));
  CHECK(mean_weighted_kappa(scores) == doctest::Approx(1 - 6.0 / 18));
  CHECK_FALSE(weighted_kappa(table_of({{2, 2}, {2, 2}}), 0, 1));
  CHECK_FALSE(mean_weighted_kappa({}));
}

TEST_CASE("scores: a rater's file is read with its remarks, and pictures without a score are left out") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.csv") << kHead << "\"Elbow\",\"R 1\",1,0a1b,4,\"a fold, \"\"flat\"\"\"\r\n"
                                  << "Elbow,R 1,2,ffff,,\"\"\r\n\r\n";
  const RaterScores rater = read_scores(folder / "a.csv");
  CHECK(rater.rater == "R 1");
  REQUIRE(rater.scores.size() == 1);
  CHECK(rater.scores.at("0a1b").score == 4);
  CHECK(rater.scores.at("0a1b").order == 1);
  CHECK(rater.scores.at("0a1b").remark == "a fold, \"flat\"");
}

TEST_CASE("scores: a wrong file is refused in one line that says where") {
  const test::TemporaryFolder folder;
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {"", "no scores"},
           {"picture,score\n0a,3\n", "not a file of scores"},
           {kHead, "no scores"},
           {kHead + "E,R,1,0a,,\n", "no scores"},
           {kHead + "E,R,1,0a,6,\n", "line 2"},
           {kHead + "E,R,1,0a,2.5,\n", "score is not valid"},
           {kHead + "E,R,-1,0a,2,\n", "order is not valid"},
           {kHead + "E,,1,0a,2,\n", "no name"},
           {kHead + "E,R,1,0a,2\n", "six fields"},
           {kHead + "E,R,1,,2,\n", "no code of a picture"},
           {kHead + "E,R,1,0a,2,\nE,R,2,0a,3,\n", "twice"},
           {kHead + "E,R,1,0a,2,\nE,S,2,0b,3,\n", "two raters"},
       }) {
    std::ofstream(folder / "a.csv") << text;
    std::string said;
    try {
      read_scores(folder / "a.csv");
    } catch (const Error& error) {
      said = error.what();
    }
    INFO(text, " -> ", said);
    CHECK(said.find(named) != std::string::npos);
    CHECK(said.find("a.csv") != std::string::npos);
    CHECK(said.find('\n') == std::string::npos);
  }
}

TEST_CASE("scores: the mean of each technique is over all raters and poses, and a stranger's picture is refused") {
  Study study{.name = "E", .spacings = {2.0}};
  study.poses = {{.name = "bent", .flex = {"A=1"}}};
  study.techniques = techniques_of({"lbs", "fem"}, "");
  const CellResult linear{.cell = {0, 0, 0}}, fem{.cell = {0, 0, 1}};
  const std::vector<RatedPicture> pictures{{"aa", &linear, "", ""}, {"bb", &fem, "", ""}};
  std::vector<RaterScores> raters{{"1.csv", "R", {{"aa", {1, 2, ""}}, {"bb", {2, 5, "fine"}}}},
                                  {"2.csv", "S", {{"aa", {2, 3, ""}}, {"bb", {1, 5, ""}}}}};
  const RatingResult result = rate(study, pictures, raters);
  CHECK(result.techniques[0].mean == 2.5);
  CHECK(result.techniques[0].deviation == doctest::Approx(std::sqrt(0.5)));
  CHECK(result.techniques[1].mean == 5);
  CHECK(result.csv.find("R,2,bb,2,bent,fem,5,fine\r\n") != std::string::npos);
  CHECK(result.alpha);
  raters[1].rater = "R";
  CHECK_THROWS_AS(rate(study, pictures, raters), Error);
  raters[1] = {"2.csv", "S", {{"cc", {1, 1, ""}}}};
  CHECK_THROWS_AS(rate(study, pictures, raters), Error);
}
