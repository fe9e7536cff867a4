// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs the guide's example, from a posed volume to the energy that it absorbs from a field
// (assets/examples/sar_openems.py).
#include <filesystem>
#include <fstream>
#include <iterator>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

using namespace limber::test;

namespace {

ProgramRun sar(std::vector<std::string> words) {
  words.insert(words.begin(), LIMBER_SOURCE_DIR "/assets/examples/sar_openems.py");
  return run_program("/usr/bin/python3", words);
}

bool can_simulate() {
  return has_program("openEMS") && run_program("/usr/bin/python3", {"-c", "import h5py, numpy, scipy"}).exit_code == 0;
}

nlohmann::json read(const std::filesystem::path& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in);
}

}  // namespace

TEST_CASE(
    "sar example: a ball takes up what Mie's solution says within a tenth, a study's posed arm has a peak over 10 g "
    "above its average, and the study's page shows both") {
  if (!can_simulate()) {
    MESSAGE("SKIPPED: openEMS, or python's h5py, numpy or scipy, is not installed");
    return;
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "study.json")
      << R"({"phantom": "arm", "spacings_mm": [8], "methods": ["dqs"], "poses": [{"name": "bent",
        "flex": ["Forearm=60"]}]})";
  const std::vector<std::string> experiment{"experiment", folder / "study.json", "-o", folder / "out"};
  REQUIRE(run_limber(experiment).exit_code == 0);
  const auto study = sar({"study", folder / "out", "--limber", LIMBER_PROGRAM});
  REQUIRE_MESSAGE(study.exit_code == 0, study.out, study.err);
  const auto figures = read(folder / "out" / "sar.json");
  CHECK(std::abs(figures["sphere"]["difference_percent"].get<double>()) < 10);
  REQUIRE(figures["poses"].size() == 1);
  CHECK(figures["poses"][0]["pose"] == "bent");
  CHECK(figures["poses"][0]["cell_mm"] == 8);
  CHECK(figures["poses"][0]["sar_peak_10g_w_per_kg"] > figures["poses"][0]["sar_average_w_per_kg"]);
  const auto counted = [](const nlohmann::json& of) {
    return of["cells_valid"].get<int>() + of["cells_used"].get<int>() + of["cells_unused"].get<int>() +
           of["cells_without"].get<int>();
  };
  CHECK(counted(figures["poses"][0]) == figures["poses"][0]["cells"].get<int>());
  CHECK(figures["poses"][0]["cells_unused"] > 0);
  REQUIRE(run_limber(experiment).exit_code == 0);
  std::ifstream page(folder / "out" / "report.html");
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  CHECK(html.find("id=\"sar\"") != html.npos);
  CHECK(html.find("Left out") == html.npos);
  const auto none = sar({"study", folder / "out", "--method", "fem", "--limber", LIMBER_PROGRAM});
  CHECK(none.exit_code == 1);
  CHECK(none.err.find("no such cells") != none.err.npos);

  const auto posed =
      folder / "out" / read(folder / "out" / "cells.json")["cells"][0]["folder"].get<std::string>() / "posed.nrrd";
  const auto deck = run_limber({"convert", posed, folder / "elbow.xml", "--frequency", "900e6"});
  REQUIRE_MESSAGE(deck.exit_code == 0, deck.err);
  const auto coarse = sar({"deck", folder / "elbow.xml", "--cell", "20", "-o", folder / "coarse.json"});
  CHECK(coarse.exit_code == 0);
  const auto of_coarse = read(folder / "coarse.json")["elbow"];
  CHECK(of_coarse["cells_heavier_than_10g"] > 0);  // a cell of cortical bone weighs 15 g
  CHECK(coarse.err.find("make --cell smaller") != std::string::npos);
  const auto arm =
      sar({"deck", folder / "elbow.xml", "--cell", "12", "-o", folder / "sar.json", "--plot", folder / "sar.svg"});
  REQUIRE_MESSAGE(arm.exit_code == 0, arm.out, arm.err);
  const auto of_elbow = read(folder / "sar.json")["elbow"];
  CHECK(of_elbow["mass_kg"].get<double>() > 1);
  CHECK(of_elbow["sar_average_w_per_kg"].get<double>() > 0);
  CHECK(of_elbow["sar_peak_10g_w_per_kg"].get<double>() > of_elbow["sar_average_w_per_kg"].get<double>());
  std::ifstream figure(folder / "sar.svg");
  const std::string svg{std::istreambuf_iterator<char>(figure), {}};
  CHECK(svg.starts_with("<svg"));
  CHECK(svg.ends_with("</svg>\n"));
  for (const char* shown : {">elbow<", "average", "largest over 10 g"})
    CHECK_MESSAGE(svg.find(shown) != std::string::npos, shown);
}
