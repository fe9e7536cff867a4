// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests `limber mesh` and `limber resample --mesh-out` on whole bodies. Reads the files that they write by the rules of
// other programs.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <doctest/doctest.h>

#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// The files of a phantom as the example ICRP145_HumanPhantoms of Geant4 reads them: word by word, by the same rules.
struct ByGeant4 {
  std::vector<std::array<double, 3>> nodes;  // cm
  std::vector<std::array<int, 4>> tets;
  std::vector<int> organ;
  std::map<int, double> cm3, density;
  std::map<int, std::string> name;
  std::set<int> coloured;

  explicit ByGeant4(const std::string& stem) {
    std::ifstream node(stem + ".node"), ele(stem + ".ele"), material(stem + ".material"),
        colour(std::filesystem::path(stem).replace_filename("colour.dat"));
    int count = 0, skipped = 0;
    node >> count >> skipped >> skipped >> skipped;
    for (int i = 0; i < count; ++i) {
      std::array<double, 3> at{};
      node >> skipped >> at[0] >> at[1] >> at[2];
      nodes.push_back(at);
    }
    ele >> count >> skipped >> skipped;
    for (int i = 0; i < count; ++i) {
      std::array<int, 4> corners{};
      int number = 0;
      ele >> skipped;
      for (int& corner : corners) ele >> corner;
      ele >> number;
      tets.push_back(corners);
      organ.push_back(number);
      cm3[number] += volume_of(corners);
    }
    CHECK(node);
    CHECK(ele);
    std::string word;
    while (!material.eof()) {
      std::string organ_name, density_word, unit, id;
      material >> word >> organ_name >> density_word >> unit >> id;
      const int number = std::atoi(id.substr(1).c_str());
      name[number] = organ_name;
      density[number] = std::atof(density_word.c_str());
      for (;;) {
        material >> word;
        CHECK(word.size() < 50);  // Geant4 reads each word into a buffer of 50 characters
        if (word == "C" || material.eof()) break;
        material >> word;
      }
      if (word == "C") material.seekg(-1, std::ios::cur);
    }
    double red = 0, green = 0, blue = 0, alpha = 0;
    for (int number = 0; colour >> number >> red >> green >> blue >> alpha;) {
      CHECK(std::max({red, green, blue, alpha}) <= 1);
      coloured.insert(number);
    }
  }
  double volume_of(const std::array<int, 4>& corners) const {
    std::array<std::array<double, 3>, 3> e{};
    for (int i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis) e[i][axis] = nodes[corners[i + 1]][axis] - nodes[corners[0]][axis];
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
  }
};

struct Arm {
  TemporaryFolder folder;
  std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json";
  Arm() { REQUIRE(run_limber({"phantom", "arm", "--spacing", "6", "-o", folder.path()}).exit_code == 0); }
};

std::string bytes_of(const std::string& path) {
  std::ostringstream all;
  all << std::ifstream(path, std::ios::binary).rdbuf();
  return all.str();
}

}  // namespace

TEST_CASE("mesh command: Geant4 reads every organ with the volume of its voxels, a material and a colour") {
  const Arm arm;
  const std::string stem = arm.folder / "arm";
  const ProgramRun run =
      run_limber({"mesh", arm.volume, "--tissues", arm.tissues, "--unit", "cm", "-o", stem + ".node"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const ByGeant4 read(stem);
  const VolumeFile file = read_volume(arm.volume);
  std::map<int, double> voxels;
  for (const Label label : file.volume.voxels)
    if (label != 0) voxels[label] += file.volume.grid.voxel_volume() / 1000;
  CHECK(read.cm3.size() == voxels.size());
  for (const auto& [label, cm3] : voxels) {
    INFO("organ ", label);
    CHECK(read.cm3.at(label) == doctest::Approx(cm3).epsilon(cm3 > 10 ? 1e-3 : 1e-2));
    CHECK(read.density.at(label) > 0.2);
    CHECK_FALSE(read.name.at(label).empty());
    CHECK(read.coloured.contains(label));
  }
  for (const auto& tet : read.tets) CHECK(read.volume_of(tet) > 0);
}

TEST_CASE("mesh command: rest and pose have the same tets, and bone keeps its shape" * doctest::test_suite("slow")) {
  const Arm arm;
  const auto pose = [&](const std::string& angle, const std::string& method) {
    const std::string stem = arm.folder / ("arm" + angle + method);
    std::vector<std::string> words = {"resample",   arm.volume, "--rig",       arm.rig, "--tissues",
                                      arm.tissues,  "--method", method,        "-o",    arm.folder / "posed.nrrd",
                                      "--mesh-out", stem,       "--mesh-unit", "cm"};
    if (angle != "0") words.insert(words.end(), {"--flex", "Forearm=" + angle});
    if (method == "fem") words.insert(words.end(), {"--quality", "draft"});
    const ProgramRun run = run_limber(words);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return stem;
  };
  const std::string rest = pose("0", "dqs"), bent = pose("40", "fem");
  CHECK(bytes_of(rest + ".ele") == bytes_of(bent + ".ele"));
  CHECK(bytes_of(rest + ".material") == bytes_of(bent + ".material"));
  const ByGeant4 before(rest), after(bent);
  std::map<int, std::string> names = after.name;
  int bones = 0;
  for (const auto& [organ, cm3] : before.cm3) {
    INFO(names.at(organ));
    const bool is_bone = names.at(organ).find("bone") != std::string::npos;
    bones += is_bone;
    if (is_bone) CHECK(after.cm3.at(organ) == doctest::Approx(cm3).epsilon(1e-6));
    else if (cm3 > 20) CHECK(after.cm3.at(organ) == doctest::Approx(cm3).epsilon(0.02));
  }
  CHECK(bones > 0);
  double moved = 0;
  for (std::size_t i = 0; i < before.nodes.size(); ++i)
    moved = std::max(moved, std::abs(after.nodes[i][2] - before.nodes[i][2]));
  CHECK(moved > 5);
}

TEST_CASE("mesh command: MCNP's sets of elements hold every tet once, by the rules of its manual") {
  const Arm arm;
  const std::string path = arm.folder / "arm.inp";
  REQUIRE(run_limber({"mesh", arm.volume, "--tissues", arm.tissues, "--spacing", "12", "-o", path}).exit_code == 0);
  std::ifstream file(path);
  std::string line, block;
  std::map<std::string, std::set<int>> sets;
  std::set<int> materials;
  int nodes = 0, elements = 0;
  while (std::getline(file, line)) {
    CHECK(line.size() < 256);
    if (line.starts_with("*")) {
      block = line;
      if (line.starts_with("*Material, name=")) materials.insert(std::atoi(line.substr(line.rfind('_') + 1).c_str()));
      continue;
    }
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    double number = 0;
    int count = 0;
    if (block.starts_with("*Node")) ++nodes;
    if (block.starts_with("*Element")) {
      CHECK(block == "*Element, type=C3D4");
      ++elements;
      for (int corner = 0; numbers >> corner; ++count) CHECK(corner >= 1);
      CHECK(count == 5);
    }
    if (block.starts_with("*Elset"))
      while (numbers >> number) CHECK(sets[block].insert(int(number)).second);
  }
  CHECK(nodes > 100);
  for (const std::string kind : {"material", "statistic"}) {
    std::set<int> all;
    for (const auto& [name, members] : sets) {
      if (name.find("elset=Set-" + kind + "_") == std::string::npos) continue;
      CHECK(materials.contains(std::atoi(name.substr(name.rfind('_') + 1).c_str())));
      for (const int element : members) CHECK(all.insert(element).second);
    }
    CHECK(int(all.size()) == elements);
  }
}

TEST_CASE("mesh command: a folder that does not exist, a table as volume and a tiny spacing are one clear line each") {
  const Arm arm;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"mesh", arm.volume, "-o", arm.folder / "nowhere/arm.node"},
        {"mesh", arm.tissues, "-o", arm.folder / "arm.node"},
        {"mesh", arm.volume, "--spacing", "0.01", "-o", arm.folder / "arm.node"}}) {
    const ProgramRun run = run_limber(words);
    CHECK(run.exit_code == 1);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
  CHECK_FALSE(std::filesystem::exists(arm.folder / "arm.node"));

  // At a spacing that thin tissues do not survive, the command says so.
  const ProgramRun coarse = run_limber({"mesh", arm.volume, "--spacing", "60", "-o", arm.folder / "arm.vtu"});
  CHECK(coarse.exit_code == 0);
  CHECK(coarse.err.find("by more than 1 %") != std::string::npos);
}
