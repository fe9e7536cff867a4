// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests `limber experiment` for sceptical readers: repeats, a form for raters, and a bundle with which others compute
// the study again.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

void describe(const Path& path, const std::string& body) {
  std::ofstream(path) << R"({"name": "Small </script> & quick", "spacings_mm": [10], "methods": ["lbs", "dqs"], )"
                      << body << R"(, "poses": [{"name": "+0"}, {"name": "+40", "flex": ["Forearm=40"]}]})";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Returns the picture codes of the form with their methods, read from the key file.
std::vector<std::pair<std::string, std::string>> key_of(const Path& file) {
  std::vector<std::pair<std::string, std::string>> key;
  std::istringstream rows(read_file(file));
  std::string row;
  std::getline(rows, row);
  CHECK(row == "picture,spacing_mm,pose,method\r");
  while (std::getline(rows, row)) {
    CHECK(has(row, ",10,+40,"));
    key.emplace_back(row.substr(0, row.find(',')), row.substr(row.rfind(',') + 1, row.size() - row.rfind(',') - 2));
  }
  return key;
}

}  // namespace

TEST_CASE("experiment: repeats give times with a range, and the form for raters hides what its key says" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path study = folder / "study.json", out = folder / "out";
  describe(study, R"("phantom": "arm", "repeats": 3)");
  std::vector<std::string> command{"experiment", study, "-o", out, "--rating-form"};
  const auto run = run_limber(command);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const json cells = json::parse(read_file(out / "cells.json"))["cells"];
  for (const json& cell : cells) {
    std::vector<double> seconds = cell["repeats"]["cpu_seconds"];
    REQUIRE(seconds.size() == 3);
    std::sort(seconds.begin(), seconds.end());
    CHECK(cell["cpu_seconds"] == seconds[1]);
  }
  std::string page = read_file(out / "report.html");
  CHECK(has(page, "the 3 repeats of each"));
  CHECK(has(page, "Divided by linear blend’s time"));
  CHECK_FALSE(has(page, "id=\"realism\""));

  const std::string form = read_file(out / "rating.html");
  for (const char* said : {"lbs", "dqs", "Linear", "Dual", "+40", "http:", "https:", "src=\"/"})
    CHECK_FALSE_MESSAGE(has(form, said), said);
  CHECK(has(form, "Small &lt;/script&gt; &amp; quick"));
  const auto key = key_of(out / "rating_key.csv");
  REQUIRE(key.size() == 2);
  CHECK(key[0].first < key[1].first);
  for (const auto& [code, method] : key) CHECK(has(form, code));

  std::string files;
  for (const char* rater : {"R", "S"}) {
    std::ofstream file(folder / (std::string(rater) + ".csv"));
    file << "study,rater,order,picture,score,remark\r\n";
    for (const auto& [code, method] : key)
      file << "E," << rater << ",1," << code << (method == "lbs" ? ",2,\r\n" : ",4,\r\n");
    files += (files.empty() ? "" : ",") + (folder / (std::string(rater) + ".csv")).string();
  }
  command.insert(command.end(), {"--scores", files});
  REQUIRE(run_limber(command).exit_code == 0);
  page = read_file(out / "report.html");
  CHECK(has(page, "id=\"realism\""));
  CHECK(has(page, "<td>2.00</td><td>0.00</td><td>2</td>"));
  CHECK(has(page, "alpha (ordinal) 1.00"));
  CHECK(has(read_file(out / "scores.csv"), "S,1," + key[0].first + ",10,+40," + key[0].second));

  std::ofstream(folder / "R.csv", std::ios::app) << "E,R,2,12345678,3,\r\n";
  const auto refused = run_limber(command);
  CHECK(refused.exit_code == 1);
  CHECK(has(refused.err, "the picture 12345678 is not of this study"));
}

TEST_CASE("experiment: a bundle that is computed elsewhere gives the same digits, and says so if it does not" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path study = folder / "study.json", bundle = folder / "bundle", moved = folder / "far" / "away";
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder / "arm"}).exit_code == 0);
  describe(study, R"("volume": "arm/volume.nrrd", "rig": "arm/rig.json", "tissues": "arm/tissues.json")");
  const auto run = run_limber({"experiment", study, "-o", folder / "out", "--bundle", bundle});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  for (const char* file : {"study.json", "expected.json", "README.txt", "inputs/volume.nrrd", "inputs/rig.json"})
    CHECK_MESSAGE(fs::exists(bundle / file), file);
  fs::create_directories(folder / "far");
  fs::rename(bundle, moved);
  fs::remove_all(folder / "arm");
  fs::remove_all(folder / "out");

  const std::vector<std::string> again{"experiment",     moved / "study.json", "-o",
                                       folder / "again", "--expect",           moved / "expected.json"};
  const auto same = run_limber(again);
  INFO(same.err);
  CHECK(same.exit_code == 0);
  CHECK(has(same.out, "the results are identical: every voxel and every figure of 4 cells"));

  json expected = json::parse(read_file(moved / "expected.json"));
  const json whole = expected;
  const auto refused = [&](const std::string& named) {
    std::ofstream(moved / "expected.json") << expected;
    const auto run = run_limber(again);
    INFO(run.err);
    CHECK(run.exit_code == 1);
    CHECK(has(run.err, named));
    CHECK(run.err.find("limber: ") == run.err.rfind("limber: "));
    expected = whole;
  };
  expected["cells"][2]["report"]["total"]["voxels_after"] = 1;
  refused("1 of 4 cells have different numbers");
  expected["cells"][1]["voxels_sha256"] = "0";
  refused("/voxels_sha256 is");
  expected["cells"].erase(0);
  refused("have 3 cells");
  expected["inputs"][0]["sha256"] = "0";
  refused("is not the one that the expected results were made from");
  expected = "text";
  refused("not a file of expected results");
  std::ofstream(moved / "expected.json") << whole;

  const auto twice = run_limber({"experiment", moved / "study.json", "-o", folder / "again", "--bundle", moved});
  CHECK(twice.exit_code == 1);
  CHECK(has(twice.err, "is not empty"));
  REQUIRE(run_limber({"experiment", moved / "study.json", "-o", folder / "again", "--bundle", folder / "hashes",
                      "--without-volumes"})
              .exit_code == 0);
  CHECK_FALSE(fs::exists(folder / "hashes" / "inputs" / "volume.nrrd"));
  CHECK(fs::exists(folder / "hashes" / "inputs" / "rig.json"));
  CHECK(has(read_file(folder / "hashes" / "README.txt"), "The volumes are not in this folder"));
}
