// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs `limber batch` as a user does. tests/cluster runs batches in many processes and kills some of them.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {
std::vector<std::vector<std::string>> rows_of(const std::string& table) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, '\t');) rows.back().push_back(field);
  }
  return rows;
}

std::string write_batch(const TemporaryFolder& folder, const std::string& exports) {
  std::ofstream(folder / "batch.json") << R"({"bodies": [{"name": "an arm", "phantom": "arm", "spacing_mm": 8}],
    "poses": [{"name": "rest"}, {"name": "+30", "flex": ["Forearm=30"]}, {"name": "no", "flex": ["Tail=30"]}],
    "methods": ["lbs", "dqs"], "volumes": ["jacobian"], "exports": )"
                                       << exports << "}";
  return folder / "batch.json";
}
}  // namespace

TEST_CASE("batch: one cell that fails stops no other, what is there is kept, and a plan tells it") {
  const TemporaryFolder folder;
  const std::string batch = write_batch(folder, R"([".stl"])"), out = folder / "out";
  const auto plan = run_limber({"batch", batch, "-o", out, "--plan"});
  REQUIRE(plan.exit_code == 0);
  const auto rows = rows_of(plan.out);
  REQUIRE(rows.size() == 7);
  CHECK(rows[0] == std::vector<std::string>{"cell", "state", "body", "pose", "method", "folder"});
  CHECK(rows[4][0] == "4");
  CHECK(rows[4][1] == "missing");
  CHECK(rows[4][2] == "an arm");
  CHECK(rows[4][3] == "+30");
  CHECK(rows[4][4] == "dqs");

  const auto one = run_limber({"batch", batch, "-o", out, "--cells", "4", "--threads", "1"});
  CHECK(one.exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(folder / "out" / "cells.csv"));
  CHECK(rows_of(run_limber({"batch", batch, "-o", out, "--plan"}).out)[4][1] == "done");

  const auto all = run_limber({"batch", batch, "-o", out});
  CHECK(all.exit_code == 1);
  CHECK(all.err.find("2 of 6 cells failed") != std::string::npos);
  CHECK(all.err.find("an arm, +30, dqs: already computed") != std::string::npos);
  CHECK(all.err.find("an arm, no, lbs: FAILED: ") != std::string::npos);
  const Path cell = rows[4][5];
  for (const char* name : {"posed.nrrd", "jacobian.nrrd", "report.json", "job.json", "cell.json"})
    CHECK(std::filesystem::exists(cell / name));
  const std::string table = read_file(folder / "out" / "cells.csv");
  CHECK(table.starts_with("body,pose,frame,method,group,item,quantity,value\r\n"));
  CHECK(table.find("an arm,+30,,dqs,tissues,skin,volume_change_percent,") != std::string::npos);
  CHECK(table.find("an arm,no,,lbs,cell,,failure,") != std::string::npos);
  CHECK(read_file(folder / "out" / "times.csv").find("an arm,+30,,dqs,") != std::string::npos);

  // The cell's volume equals the one that `limber resample` makes of the same inputs.
  const Path body = std::filesystem::directory_iterator(folder / "out" / "bodies")->path();
  const auto direct = run_limber({"resample", body / "volume.nrrd", "--rig", body / "rig.json", "--tissues",
                                  body / "tissues.json", "--weights", body / "weights.nrrd", "--flex", "Forearm=30",
                                  "--method", "dqs", "-o", folder / "direct.nrrd"});
  REQUIRE(direct.exit_code == 0);
  CHECK(read_file(folder / "direct.nrrd") == read_file(cell / "posed.nrrd"));

  // If the batch is run again with another export format, the poses that it computed before are not computed again.
  const auto before = std::filesystem::last_write_time(cell / "cell.json");
  write_batch(folder, R"([".vti"])");
  run_limber({"batch", batch, "-o", out, "--shard", "2/2"});
  CHECK(std::filesystem::last_write_time(cell / "cell.json") == before);
  CHECK(std::filesystem::exists(folder / "out" / "exports"));
  int grids = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out" / "exports"))
    grids += entry.path().filename() == "posed.vti";
  CHECK(grids == 2);

  // A damaged cell is computed again.
  std::filesystem::remove(cell / "report.json");
  CHECK(rows_of(run_limber({"batch", batch, "-o", out, "--plan"}).out)[4][1] == "missing");
  CHECK(run_limber({"batch", batch, "-o", out, "--cells", "4"}).exit_code == 0);
  CHECK(std::filesystem::exists(cell / "report.json"));
}

TEST_CASE("batch: the example runs" * doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const auto run = run_limber({"batch", LIMBER_SOURCE_DIR "/assets/examples/batch.json", "-o", folder / "out"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("12 of 12  fine, by joints, dqs: done") != std::string::npos);
}

TEST_CASE("batch: what cannot be is one clear line") {
  const TemporaryFolder folder;
  const std::string batch = write_batch(folder, R"([".stl"])");
  for (const char* cells : {"0", "7", "x", "3-2", "1,,2", "1-2-3"}) {
    const auto run = run_limber({"batch", batch, "-o", folder / "out", "--cells=" + std::string(cells)});
    INFO(cells, run.err);
    CHECK(run.exit_code != 0);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
  CHECK(run_limber({"batch", batch, "-o", folder / "out", "--shard", "3/2"}).exit_code == 1);
  CHECK(run_limber({"batch", batch, "-o", folder / "out", "--shard", "1/2", "--cells", "1"}).exit_code == 2);
  CHECK(run_limber({"batch", folder / "none.json", "-o", folder / "out"}).exit_code == 1);
  CHECK(run_limber({"batch"}).exit_code == 2);
  std::ofstream(folder / "file") << "x";
  CHECK(run_limber({"batch", batch, "-o", folder / "file"}).err.find("file") != std::string::npos);
}
