// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs `limber experiment` as a user does: to its end, in shards, and resumed after a kill.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

void describe(const Path& path, const std::string& methods,
              const std::string& poses = R"([{"name": "+0"}, {"name": "+40", "flex": ["Forearm=40"]}])") {
  std::ofstream(path)
      << R"({"name": "Small & quick", "phantom": "arm", "spacings_mm": [8], "quality": "draft", "methods": )" << methods
      << R"(, "poses": )" << poses << "}";
}

// Returns the report without the values that differ from run to run.
json without_times(json value) {
  if (value.is_object())
    for (const char* key : {"cpu_seconds", "wall_seconds", "seconds", "peak_memory_mb"}) value.erase(key);
  if (value.is_structured())
    for (json& inner : value) inner = without_times(inner);
  return value;
}
json cells_of(const Path& folder) { return without_times(json::parse(read_file(folder / "cells.json"))); }

int cells_there(const Path& folder) {
  int cells = 0;
  if (fs::exists(folder / "cells"))
    for (const auto& entry : fs::directory_iterator(folder / "cells"))
      cells += entry.path().filename().string()[0] != '.';
  return cells;
}

// Starts the study, waits until `cells` cells are computed and then `after` seconds, and sends it a signal. Returns its
// exit code, or 128 + the signal's number if a signal ended it.
int ended_by(int signal, const Path& study, const Path& out, int cells, double after) {
  const pid_t child = ::fork();
  if (child == 0) {
    const int nothing = ::open("/dev/null", O_WRONLY);
    ::dup2(nothing, 1);
    ::dup2(nothing, 2);
    ::execl(LIMBER_PROGRAM, "limber", "experiment", study.c_str(), "-o", out.c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  while (cells_there(out) < cells && ::waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::duration<double>(after));
  ::kill(child, signal);
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::size_t count(const std::string& text, const std::string& of) {
  std::size_t found = 0;
  for (std::size_t at = text.find(of); at != text.npos; at = text.find(of, at + of.size())) ++found;
  return found;
}

}  // namespace

TEST_CASE(
    "experiment: a study gives tables and one self-contained page, and killed after a random cell and taken up again "
    "the same" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path study = folder / "study.json", whole = folder / "whole", killed = folder / "killed";
  describe(study, R"(["lbs", "dqs", "fem"])");
  const auto run = run_limber({"experiment", study, "-o", whole});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(count(run.err, ": done") == 6);
  CHECK(run.err.find(" left") != std::string::npos);

  const json cells = cells_of(whole);
  CHECK(cells["schema"] == "limber-study/1");
  CHECK(cells["sources"].get<std::string>().size() == 64);
  CHECK(cells.contains("commit"));
  REQUIRE(cells["cells"].size() == 6);
  std::set<std::string> seen;
  for (const json& cell : cells["cells"]) {
    seen.insert(cell["pose"].get<std::string>() + " " + cell["method"].get<std::string>());
    CHECK(cell["spacing_mm"] == 8);
    CHECK(cell["report"]["schema"] == "limber-report/1");
    CHECK(cell["gates"].size() == 20);
    for (const json& gate : cell["label_gates"]) {
      CHECK(gate["voxels"] >= 500);
      CHECK(gate["passed"] == (std::abs(gate["volume_change_percent"].get<double>()) <= 1));
    }
    for (const json& input : cell["report"]["inputs"]) CHECK_FALSE(input["path"].get<std::string>().starts_with("/"));
    if (cell["pose"] == "+0") {
      CHECK(cell["report"]["total"]["volume_change_percent"] == 0);
      CHECK(cell["report"]["total"]["overlap_voxels"] == 0);
      CHECK_FALSE(cell["report"].contains("joints"));
    } else {
      CHECK(cell["report"]["joints"][0]["bone"] == "Forearm");
      CHECK(cell["report"]["joints"][0]["degrees"].get<double>() == doctest::Approx(40));
    }
    CHECK(cell["report"].contains("solve") == (cell["method"] == "fem" && cell["pose"] != "+0"));
  }
  CHECK(seen.size() == 6);

  const std::string observations = read_file(whole / "observations.csv");
  CHECK(observations.starts_with("spacing_mm,pose,frame,method,group,item,quantity,value\r\n"));
  std::istringstream rows(observations);
  std::set<std::string> keys;
  for (std::string row; std::getline(rows, row);) CHECK_MESSAGE(keys.insert(row.substr(0, row.rfind(','))).second, row);
  CHECK(observations.find("8,+40,,fem,solve,,parameters.tet_mm,") != std::string::npos);
  CHECK(read_file(whole / "times.csv").starts_with("spacing_mm,pose,frame,method,machine,quantity,value\r\n"));
  CHECK(observations.find("tissues,skin,volume_change_percent,") != std::string::npos);
  const std::string table = read_file(whole / "cells.csv");
  CHECK(count(table, "\r\n") == 7);
  CHECK(table.starts_with("spacing_mm,pose,method,"));
  CHECK(table.find(",tissues.fat.volume_change_percent,") != std::string::npos);

  const std::string page = read_file(whole / "report.html");
  CHECK(page.starts_with("<!doctype html>"));
  CHECK(page.ends_with("</html>\n"));
  CHECK(page.find("Small &amp; quick") != std::string::npos);
  for (const char* outside : {"<script", "http:", "https:", "<link", "src=\"/"})
    CHECK_MESSAGE(page.find(outside) == std::string::npos, outside);
  CHECK(count(page, "url(") == count(page, "url(data:font/woff2;base64,"));
  CHECK(count(page, "url(") == 3);
  CHECK(count(page, "class=\"tissue-legend\"") >= 3);
  CHECK(count(page, "data:image/png;base64,") >= 6);
  for (const char* part :
       {"id=\"summary\"", "id=\"time\"", "id=\"volume\"", "id=\"pictures\"", "id=\"worst\"", "id=\"gates\"",
        "id=\"methods\"", "id=\"provenance\"", "How to cite", "prefers-color-scheme:dark", "@media print"})
    CHECK_MESSAGE(page.find(part) != std::string::npos, part);
  for (const char* tag : {"figure", "table", "tr", "td", "th", "svg", "figcaption", "thead"})
    CHECK_MESSAGE(count(page, std::string("</") + tag + ">") ==
                      count(page, std::string("<") + tag + ">") + count(page, std::string("<") + tag + " "),
                  tag);

  std::random_device random;
  const int after = static_cast<int>(random() % 5);
  INFO("killed after ", after, " cells");
  CHECK(ended_by(SIGKILL, study, killed, after, (random() % 1000) * 3e-4) == 128 + SIGKILL);
  CHECK_FALSE(fs::exists(killed / "cells.json"));
  const int kept = cells_there(killed);
  CHECK(kept >= after);
  const auto rest = run_limber({"experiment", study, "-o", killed});
  INFO(rest.err);
  REQUIRE(rest.exit_code == 0);
  CHECK(count(rest.err, ": already computed") == std::size_t(kept));
  CHECK(count(rest.err, ": done") == std::size_t(6 - kept));
  CHECK(cells_of(killed) == cells);
  for (const auto& entry : fs::recursive_directory_iterator(killed))
    CHECK_MESSAGE(entry.path().filename().string()[0] != '.', entry.path().string());

  const auto again = run_limber({"experiment", study, "-o", killed});
  CHECK(count(again.err, ": already computed") == 6);
  CHECK(cells_of(killed) == cells);

  // Running a cell's job file makes the same volume again.
  const Path one = killed / cells["cells"][4]["folder"].get<std::string>();
  const std::string before = read_file(one / "posed.nrrd");
  REQUIRE(run_limber({"job", one / "job.json"}).exit_code == 0);
  CHECK(read_file(one / "posed.nrrd") == before);
}

TEST_CASE(
    "experiment: masses made exact are a technique of their own, and SAR that was computed of the cells is a figure of "
    "the page" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path study = folder / "study.json", out = folder / "out";
  describe(study, R"(["lbs"])");
  const std::vector<std::string> command{"experiment", study, "-o", out, "--methods", "dqs,dqs-mass-exact"};
  REQUIRE(run_limber(command).exit_code == 0);
  const json cells = cells_of(out)["cells"];
  REQUIRE(cells.size() == 4);
  CHECK_FALSE(cells[2]["report"].contains("mass_exact"));
  const json& exact = cells[3]["report"]["mass_exact"];
  CHECK(exact["changed_voxels"] > 0);
  for (const json& tissue : exact["tissues"])
    CHECK(std::abs(tissue["voxels_after"].get<int>() - tissue["voxels_wanted"].get<int>()) <=
          std::abs(tissue["voxels_before"].get<int>() - tissue["voxels_wanted"].get<int>()));
  const std::string page = read_file(out / "report.html");
  CHECK(page.find("Dual quaternions, mass-exact") != page.npos);
  CHECK(page.find("Voxels changed by mass-exact") != page.npos);
  CHECK(page.find("id=\"sar\"") == page.npos);

  json sar{
      {"schema", "limber-sar/2"},
      {"frequency_hz", 9e8},
      {"cell_mm", 6},
      {"polarization", "z"},
      {"towards", "y"},
      {"spacing_mm", 8},
      {"method", "dqs"},
      {"sphere", {{"cell_mm", 6}, {"absorbed_w", 0.0102}, {"absorbed_by_mie_w", 0.01}, {"difference_percent", 2.0}}}};
  for (const int i : {2, 0})
    sar["poses"].push_back({{"pose", cells[i]["pose"]},
                            {"key", cells[i]["key"]},
                            {"sar_average_w_per_kg", 0.0123 + 1e-3 * i},
                            {"sar_peak_10g_w_per_kg", 0.0667},
                            {"mass_kg", 2.5},
                            {"seconds", 68},
                            {"cells", 12000}});
  const auto page_with = [&](const json& of) {
    std::ofstream(out / "sar.json") << of;
    const auto run = run_limber(command);
    CHECK(count(run.err, ": already computed") == 4);
    return run.exit_code == 0 ? read_file(out / "report.html") : run.err;
  };
  const std::string shown = page_with(sar);
  for (const char* part : {"id=\"sar\"", "900 MHz", "+2.0 %", "<td>12.30</td><td>66.7</td>", "<td>14.30</td>",
                           "Largest average over 10 g"})
    CHECK_MESSAGE(shown.find(part) != shown.npos, part);
  CHECK(shown.find("<td>12.30</td>") < shown.find("<td>14.30</td>"));
  CHECK(shown.find("Left out") == shown.npos);
  sar["sphere"]["difference_percent"] = -12;
  sar["poses"][0]["key"] = "of another program";
  const std::string doubted = page_with(sar);
  for (const char* part : {"do not trust", "Left out:</b> SAR of +40", "<td>12.30</td>"})
    CHECK_MESSAGE(doubted.find(part) != doubted.npos, part);
  CHECK(doubted.find("<td>14.30</td>") == doubted.npos);
  for (const json& damaged : {json("text"), json{{"schema", "limber-sar/2"}}, json{{"schema", "limber-sar/1"}}}) {
    const std::string said = page_with(damaged);
    INFO(said);
    CHECK(said.find("sar.json") != said.npos);
    CHECK(said.find("limber: ") != said.npos);
  }
}

TEST_CASE("experiment: shards compute each their own cells, and a run without one collects them" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path study = folder / "study.json", out = folder / "out";
  describe(study, R"(["lbs", "dqs"])");
  for (const char* shard : {"1/2", "2/2"}) {
    const auto run = run_limber({"experiment", study, "-o", out, "--shard", shard});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(count(run.err, ": done") == 2);
    CHECK_FALSE(fs::exists(out / "cells.json"));
  }
  const auto all = run_limber({"experiment", study, "-o", out});
  REQUIRE(all.exit_code == 0);
  CHECK(count(all.err, ": already computed") == 4);
  CHECK(cells_of(out)["cells"].size() == 4);

  // A pose is added to the study: only its cells are computed.
  describe(study, R"(["lbs", "dqs"])",
           R"([{"name": "+0"}, {"name": "+40", "flex": ["Forearm=40"]}, {"name": "+20", "flex": "Forearm=20"}])");
  const auto more = run_limber({"experiment", study, "-o", out});
  CHECK(count(more.err, ": already computed") == 4);
  CHECK(count(more.err, ": done") == 2);
}

TEST_CASE("experiment: a cancel leaves done cells and nothing half-written, and what cannot be is one clear line" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path study = folder / "study.json", out = folder / "out";
  describe(study, R"(["lbs", "dqs"])");
  CHECK(ended_by(SIGINT, study, out, 1, 0.02) == 3);
  CHECK(cells_there(out) >= 1);
  CHECK_FALSE(fs::exists(out / "report.html"));
  for (const auto& entry : fs::recursive_directory_iterator(out))
    CHECK_MESSAGE(entry.path().filename().string()[0] != '.', entry.path().string());

  const auto refused = [](const std::vector<std::string>& words, const std::string& named) {
    const auto run = run_limber(words);
    INFO(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.starts_with("limber: "));
    CHECK(run.err.find(named) != std::string::npos);
    CHECK(count(run.err, "\n") == 1);
  };
  refused({"experiment", folder / "none.json", "-o", folder / "x"}, "none.json");
  refused({"experiment", study, "-o", out, "--shard", "3/2"}, "3/2");
  refused({"experiment", study, folder.path(), "-o", out}, "arm");
  refused({"experiment", "arm", folder.path(), "-o", folder / "x"}, "no arm");
  CHECK_FALSE(fs::exists(folder / "x"));
  std::ofstream(folder / "file") << "x";
  refused({"experiment", study, "-o", folder / "file" / "out"}, "cannot be made");
  CHECK(run_limber({"experiment"}).exit_code == 2);

  // A pose that the rig does not have fails in its own cells only, and the page reports it.
  describe(study, R"(["lbs"])", R"([{"name": "+0"}, {"name": "wrong", "flex": ["Elbow=40"]}])");
  const auto wrong = run_limber({"experiment", study, "-o", out});
  CHECK(wrong.exit_code == 1);
  CHECK(wrong.err.find("limber: 1 of 2 cells failed") != std::string::npos);
  const json cells = cells_of(out);
  CHECK_FALSE(cells["cells"][0].contains("failure"));
  CHECK(cells["cells"][1]["failure"].get<std::string>().find("Elbow") != std::string::npos);
  CHECK(read_file(out / "report.html").find("Elbow") != std::string::npos);
}
