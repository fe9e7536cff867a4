// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/volume_io/landmarks.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {
struct Arm {
  TemporaryFolder folder;
  std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json";
  Arm() { REQUIRE(run_limber({"phantom", "arm", "--spacing", "10", "-o", folder.path()}).exit_code == 0); }
  ProgramRun resample(std::vector<std::string> more) const {
    more.insert(more.begin(), {"resample", volume, "--rig", rig, "--tissues", tissues});
    return run_limber(more);
  }
};

// Returns every 37th voxel centre that holds tissue as a landmark.
std::vector<Landmark> points_in(const VolumeFile& file) {
  const AffineTransform to_world = world_from_voxel(file.volume.grid);
  std::vector<Landmark> points;
  int met = 0;
  for (int z = 1; z + 1 < file.volume.grid.size.z; ++z)
    for (int y = 1; y + 1 < file.volume.grid.size.y; ++y)
      for (int x = 1; x + 1 < file.volume.grid.size.x; ++x)
        if (file.volume.at({x, y, z}) != 0 && ++met % 37 == 0)
          points.push_back({"p" + std::to_string(points.size()), to_world * glm::dvec3(x, y, z)});
  return points;
}
}  // namespace

TEST_CASE(
    "landmarks: at rest they stay, in a pose they lie in the tissue that they were in, and those of the hand move as "
    "one, by blending and by finite elements" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const auto points = points_in(read_volume(arm.volume));
  REQUIRE(points.size() > 20);
  const std::string in = arm.folder / "in.csv", out = arm.folder / "out.csv";
  write_landmarks(points, in);
  REQUIRE(arm.resample({"--method", "lbs", "-o", arm.folder / "rest.nrrd", "--landmarks", in + "=" + out}).exit_code ==
          0);
  const auto still = read_landmarks(out);
  REQUIRE(still.size() == points.size());
  for (size_t i = 0; i < points.size(); ++i) CHECK(glm::distance(still[i].position, points[i].position) < 1e-9);

  for (const std::vector<std::string>& method : std::vector<std::vector<std::string>>{
           {"lbs"}, {"dqs"}, {"fem", "--quality", "draft", "--mesh-out", arm.folder / "tets", "--mesh-unit", "cm"}}) {
    std::vector<std::string> words = {"--flex",      "Forearm=20",   "-o",      arm.folder / "bent.nrrd",
                                      "--landmarks", in + "=" + out, "--method"};
    words.insert(words.end(), method.begin(), method.end());
    const auto run = arm.resample(words);
    INFO(method.front(), ": ", run.err);
    REQUIRE(run.exit_code == 0);
    const auto posed = read_landmarks(out);
    const VolumeFile bent = read_volume(arm.folder / "bent.nrrd");
    int moved = 0, at_home = 0;
    const VolumeFile rest = read_volume(arm.volume);
    for (size_t i = 0; i < points.size(); ++i) {
      moved += glm::distance(posed[i].position, points[i].position) > 5;
      const glm::ivec3 there(glm::floor(voxel_from_world(bent.volume.grid) * posed[i].position + 0.5)),
          here(glm::floor(voxel_from_world(rest.volume.grid) * points[i].position + 0.5));
      at_home += bent.volume.grid.contains(there) && bent.volume.at(there) == rest.volume.at(here);
    }
    CHECK(moved > 5);
    std::vector<size_t> order(points.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      return glm::distance(posed[a].position, points[a].position) >
             glm::distance(posed[b].position, points[b].position);
    });
    for (size_t i = 1; i < 5; ++i)
      CHECK(glm::distance(posed[order[0]].position, posed[order[i]].position) ==
            doctest::Approx(glm::distance(points[order[0]].position, points[order[i]].position)).epsilon(1e-6));
    // Most landmarks lie in the tissue that they were in at rest; the voxels are coarse.
    CHECK(at_home > 0.8 * double(points.size()));
  }

  // The tets have organ numbers that the list of materials explains.
  std::ifstream tets(arm.folder / "tets.ele"), materials(arm.folder / "tets.material"), nodes(arm.folder / "tets.node");
  int count = 0, four = 0, one = 0, index = 0, corner = 0, organ = 0;
  std::vector<int> organs;
  for (tets >> count >> four >> one; tets >> index >> corner >> corner >> corner >> corner >> organ;)
    organs.push_back(organ);
  CHECK(static_cast<int>(organs.size()) == count);
  std::vector<int> listed;
  double density = 0, sum = 1;
  std::string word, name, unit;
  while (materials >> word) {
    if (word == "C") {
      CHECK(sum == doctest::Approx(1).epsilon(1e-4));
      materials >> name >> density >> unit >> word;
      CHECK(unit == "g/cm3");
      CHECK(density > 0.3);
      listed.push_back(std::stoi(word.substr(1)));
      sum = 0;
      continue;
    }
    double share = 0;
    materials >> share;
    CHECK(std::stoi(word) % 1000 == 0);
    sum -= share;
  }
  for (const int number : organs) CHECK(std::find(listed.begin(), listed.end(), number) != listed.end());
  double largest = 0, x = 0, y = 0, z = 0;
  for (nodes >> count >> four >> one >> one; nodes >> index >> x >> y >> z;)
    largest = std::max({largest, std::abs(x), std::abs(y), std::abs(z)});
  CHECK(largest < 100);  // the unit is cm: in mm, coordinates would be larger
  CHECK(largest > 5);
}

TEST_CASE("landmarks: what is no list of points is refused with its line, and nothing is written") {
  const Arm arm;
  const std::string in = arm.folder / "in.csv", out = arm.folder / "out.csv";
  for (const char* text : {"", "name,x,y,z\n", "a,1,2\n", "a,1,2,x\n", "a,1,2,nan\n", "a,1,2,1e300\n"}) {
    std::ofstream(in) << text;
    const auto run = arm.resample({"--method", "lbs", "-o", arm.folder / "o.nrrd", "--landmarks", in + "=" + out});
    CHECK(run.exit_code == 1);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(out));
    CHECK_FALSE(std::filesystem::exists(arm.folder / "o.nrrd"));
  }
  CHECK(arm.resample({"--method", "lbs", "-o", arm.folder / "o.nrrd", "--landmarks", "points.csv"}).exit_code == 1);
  write_landmarks({{"tip, of \"it\"", {1, 2.5, -3e-7}}}, in);
  const auto back = read_landmarks(in);
  CHECK(back[0].name == "tip, of \"it\"");
  CHECK(back[0].position == glm::dvec3(1, 2.5, -3e-7));
}
