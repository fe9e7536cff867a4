// SPDX-License-Identifier: AGPL-3.0-or-later
// The guide's example: from a posed volume to the energy that it takes up from a field (assets/examples/sar_openems.py).
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

bool can_simulate() { return has_program("openEMS") && run_program("/usr/bin/python3", {"-c", "import h5py, numpy, scipy"}).exit_code == 0; }

nlohmann::json read(const std::filesystem::path& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in);
}

}  // namespace

TEST_CASE("sar example: a ball takes up what Mie's solution says within a tenth, a posed arm's peak over 10 g lies above its average") {
  if (!can_simulate()) {
    MESSAGE("SKIPPED: openEMS, or python's h5py, numpy or scipy, is not installed");
    return;
  }
  const TemporaryFolder folder;
  const auto ball = sar({"sphere", "--cell", "8", "-o", folder / "ball.json"});
  CHECK_MESSAGE(ball.exit_code == 0, ball.out, ball.err);
  CHECK(std::abs(read(folder / "ball.json")["difference_percent"].get<double>()) < 10);

  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  REQUIRE(run_limber({"resample", folder / "volume.nrrd", "--rig", folder / "rig.json", "--tissues", folder / "tissues.json", "--flex", "Forearm=60", "--method", "dqs", "-o", folder / "posed.nrrd"}).exit_code == 0);
  const auto deck = run_limber({"convert", folder / "posed.nrrd", folder / "elbow.xml", "--frequency", "900e6"});
  REQUIRE_MESSAGE(deck.exit_code == 0, deck.err);
  const auto arm = sar({"deck", folder / "elbow.xml", "-o", folder / "sar.json", "--plot", folder / "sar.svg"});
  REQUIRE_MESSAGE(arm.exit_code == 0, arm.out, arm.err);
  const auto of_elbow = read(folder / "sar.json")["elbow"];
  CHECK(of_elbow["mass_kg"].get<double>() > 1);
  CHECK(of_elbow["sar_average_w_per_kg"].get<double>() > 0);
  CHECK(of_elbow["sar_peak_10g_w_per_kg"].get<double>() > of_elbow["sar_average_w_per_kg"].get<double>());
  std::ifstream figure(folder / "sar.svg");
  const std::string svg{std::istreambuf_iterator<char>(figure), {}};
  CHECK(svg.starts_with("<svg"));
  CHECK(svg.ends_with("</svg>\n"));
  for (const char* shown : {">elbow<", "average", "largest over 10 g"}) CHECK_MESSAGE(svg.find(shown) != std::string::npos, shown);
}
