// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/simulation_export.h"

#include <algorithm>
#include <fstream>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/export/greedy_boxes.h"
#include "tests/support/program.h"
#include "tests/support/read_back.h"

using namespace limber;
using namespace limber::test;

namespace {

LabelVolume volume_of(const glm::ivec3& size, const std::function<Label(const glm::ivec3&)>& label) {
  LabelVolume volume;
  volume.grid.size = size;
  volume.grid.spacing = {2, 3, 4};
  volume.grid.origin = {10, 20, 30};
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) volume.voxels.push_back(label({x, y, z}));
  return volume;
}

TissueMaterial material(Label label, const std::string& name) {
  return {.label = label,
          .file_value = double(label),
          .name = name,
          .density = 1000,
          .dielectric = {double(10 + label), 0.5},
          .row = name,
          .source = "test"};
}

void check_covered_once(const LabelVolume& volume, const std::vector<LabelBox>& boxes) {
  std::vector<Label> painted(volume.voxels.size(), 0);
  for (const LabelBox& box : boxes)
    for (int z = box.low.z; z < box.high.z; ++z)
      for (int y = box.low.y; y < box.high.y; ++y)
        for (int x = box.low.x; x < box.high.x; ++x) {
          Label& voxel = painted[volume.grid.index({x, y, z})];
          CHECK(voxel == 0);
          voxel = box.label;
        }
  CHECK(std::equal(painted.begin(), painted.end(), volume.voxels.begin(), volume.voxels.end()));
}

}  // namespace

TEST_CASE("decks: greedy boxes hold every tissue voxel once, and are as few as can be seen by hand") {
  const auto one = volume_of({4, 3, 2}, [](const glm::ivec3&) { return 5; });
  CHECK(greedy_boxes(one).size() == 1);
  const auto halves = volume_of({4, 3, 2}, [](const glm::ivec3& v) { return v.y < 1 ? 5 : 6; });
  CHECK(greedy_boxes(halves).size() == 2);
  const auto ring = volume_of({3, 3, 3}, [](const glm::ivec3& v) { return v == glm::ivec3(1) ? 0 : 5; });
  CHECK(greedy_boxes(ring).size() == 6);  // below, above, front, back, left, right
  const auto checkers = volume_of({3, 3, 3}, [](const glm::ivec3& v) { return (v.x + v.y + v.z) % 2; });
  CHECK(greedy_boxes(checkers).size() == 13);
  CHECK(greedy_boxes(volume_of({3, 3, 3}, [](const glm::ivec3&) { return 0; })).empty());
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) {
    const auto noise = volume_of({7, 5, 6}, [&](const glm::ivec3&) { return Label(random() % 3); });
    check_covered_once(noise, greedy_boxes(noise));
  }
  check_covered_once(ring, greedy_boxes(ring));
}

TEST_CASE("decks: openEMS' boxes lie in millimetres at voxel faces, names are plain and each once") {
  SimulationBody body{volume_of({2, 1, 1}, [](const glm::ivec3& v) { return Label(1 + v.x); }),
                      {material(1, "fat & <skin>"), material(2, "fat & <skin>")},
                      900e6};
  const std::string xml = openems_xml(body);
  CHECK(xml.find("<XLines>9,11,13</XLines>") != std::string::npos);
  CHECK(xml.find("<ZLines>28,32</ZLines>") != std::string::npos);
  CHECK(xml.find("<P1 X=\"11\" Y=\"18.5\" Z=\"28\"/><P2 X=\"13\" Y=\"21.5\" Z=\"32\"/>") != std::string::npos);
  CHECK(xml.find("Name=\"fat____skin_\"") != std::string::npos);
  CHECK(xml.find("Name=\"fat____skin__2\"") != std::string::npos);
  CHECK(xml.find("Epsilon=\"12\" Kappa=\"0.5\" Density=\"1000\"") != std::string::npos);
}

TEST_CASE("decks: a volume with other axes is turned, and stays where it is in the world") {
  LabelVolume volume = volume_of({3, 2, 1}, [](const glm::ivec3& v) { return Label(1 + v.x); });
  volume.grid.direction = glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1);  // voxel axes towards right, anterior, superior
  std::vector<std::string> warnings;
  const LabelVolume turned = turned_to_lps(volume, warnings);
  CHECK(warnings.empty());
  CHECK(turned.voxels[0] == 3);
  const SimulationBody body{turned, {material(1, "a"), material(2, "b"), material(3, "c")}, 1e9};
  // Voxel 0 of the original, with label 1, has its centre at x = 10. The x axis is turned round, so it becomes the last
  // of the three cells, from 9 to 11.
  CHECK(openems_xml(body).find("<XLines>5,7,9,11</XLines>") != std::string::npos);
  volume.grid.direction = glm::dmat3(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1);
  turned_to_lps(volume, warnings);
  CHECK(warnings.size() == 1);
}

TEST_CASE("convert: simulation decks are read back by h5py and numpy, voxel for voxel" * doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", tissues = folder / "tissues.json", nifti = folder / "v.nii.gz",
                    csv = folder / "t.csv";
  REQUIRE(run_limber({"convert", volume, nifti}).exit_code == 0);
  REQUIRE(run_limber({"tissues", volume, "--tissues", tissues, "--frequency", "900e6", "-o", csv}).exit_code == 0);
  for (const auto& [kind, name] : {std::pair{"disc", "a.csxcad.h5"}, {"gprmax", "a.gprmax.h5"}, {"icrp", "a.dat"}}) {
    const auto run = run_limber({"convert", volume, folder / name, "--tissues", tissues, "--frequency", "900e6"});
    CHECK_MESSAGE(run.exit_code == 0, run.err);
    READ_BACK(kind, folder / name, nifti, csv);
  }
  // Labels and names survive the way through a Virtual Family RAW file with its text file. Nibabel reads the volume
  // made from it.
  REQUIRE(run_limber({"convert", volume, folder / "vf.txt", "--tissues", tissues}).exit_code == 0);
  CHECK(std::filesystem::file_size(folder / "vf.raw") > 1000);
  REQUIRE(run_limber({"convert", folder / "vf.txt", folder / "vf.nii.gz"}).exit_code == 0);
}

TEST_CASE(
    "convert: a volume with every class of TotalSegmentator goes to openEMS, gprMax and ICRP slices, no name "
    "unmatched, and stand-ins are named") {
  const TemporaryFolder folder;
  const std::string volume = folder / "total.nrrd";
  std::string voxels;
  for (int label = 0; label <= 127; ++label) voxels += static_cast<char>(label <= 117 ? label : 0);
  std::ofstream(volume, std::ios::binary)
      << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 4 4\n"
         "space directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (0,0,0)\nencoding: raw\n\n"
      << voxels;
  for (const char* name : {"t.xml", "t.gprmax.h5", "t.csxcad.h5", "t.dat"}) {
    const auto run = run_limber({"convert", volume, folder / name, "--frequency", "900e6"});
    CHECK_MESSAGE(run.exit_code == 0, name, run.err);
    if (std::string(name) != "t.dat") CHECK_MESSAGE(run.err.find("pancreas as thyroid") != std::string::npos, run.err);
  }
  const auto listed = run_limber({"tissues", volume, "--frequency", "900e6", "--json"});
  CHECK(listed.exit_code == 0);
  CHECK(listed.out.find("\"unmatched\": []") != std::string::npos);
  CHECK(listed.out.find("\"found\": \"name: vena cava\"") != std::string::npos);
}

TEST_CASE("convert: openEMS reads the boxes and finds in every cell the tissue that is there") {
  NEEDS_PROGRAM("openEMS")
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "10", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", tissues = folder / "tissues.json", nifti = folder / "v.nii.gz",
                    csv = folder / "t.csv";
  REQUIRE(run_limber({"convert", volume, nifti}).exit_code == 0);
  REQUIRE(run_limber({"tissues", volume, "--tissues", tissues, "--frequency", "900e6", "-o", csv}).exit_code == 0);
  REQUIRE(run_limber({"convert", volume, folder / "arm.xml", "--tissues", tissues, "--frequency", "900e6"}).exit_code ==
          0);
  const auto run = run_program(
      "/bin/sh",
      {"-c", "cd " + folder.path().string() + " && openEMS arm.xml --debug-material --no-simulation --numThreads=1"});
  INFO(run.out, run.err);
  REQUIRE(std::filesystem::exists(folder / "material_dump.vtr"));
  READ_BACK("openems", folder / "material_dump.vtr", nifti, csv);
}

TEST_CASE(
    "convert: a deck without frequency, or of tissue without properties, is refused in one line and leaves nothing" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "10", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd";
  std::ofstream(folder / "odd.json")
      << R"({"1": {"name": "liver", "kind": "organ"}, "3": {"name": "unobtainium", "kind": "unknown"}})";
  const auto files = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
  const auto before = files();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"convert", volume, folder / "a.xml"},
           {"convert", volume, folder / "a.h5", "--frequency", "1e9"},
           {"convert", volume, folder / "a.xml", "--frequency", "1"},
           {"convert", volume, folder / "a.gprmax.h5", "--frequency", "1e9", "--tissues", folder / "odd.json"},
           {"convert", volume, folder / "a.dat", "--tissues", folder / "odd.json"},
           {"convert", volume, "/no/such/a.csxcad.h5", "--frequency", "1e9"},
           {"convert", volume, "/no/such/a.stl"}}) {
    const auto run = run_limber(words);
    CAPTURE(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.starts_with("limber: "));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
  CHECK(files() == before);
}
