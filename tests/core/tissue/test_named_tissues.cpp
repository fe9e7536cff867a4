// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts volumes with every name of the common label tables for simulations. No name may remain unmatched.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/tissue/tissue_table.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"
#include "tests/support/tissue_names_in_use.h"

using namespace limber::test;

namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::size_t count(const std::string& text, const std::string& wanted) {
  std::size_t found = 0;
  for (std::size_t at = text.find(wanted); at != text.npos; at = text.find(wanted, at + 1)) ++found;
  return found;
}

// Writes v.nrrd and t.json: one voxel for each name, in a row along x, and the table that names them.
void write_volume(const TemporaryFolder& folder, const std::vector<std::string>& names) {
  std::string voxels(2, '\0');
  nlohmann::json table;
  for (std::size_t label = 1; label <= names.size(); ++label) {
    voxels += static_cast<char>(label & 255);
    voxels += static_cast<char>(label >> 8);
    table[std::to_string(label)] = names[label - 1];
  }
  std::ofstream(folder / "t.json") << table;
  std::ofstream(folder / "v.nrrd", std::ios::binary)
      << "NRRD0004\ntype: uint16\nendian: little\ndimension: 3\nspace: left-posterior-superior\nsizes: "
      << names.size() + 1 << " 1 1\nspace directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (0,0,0)\n"
      << "encoding: raw\n\n"
      << voxels;
}

// Checks that each tissue has all data that openEMS, gprMax and ICRP slices need, and that each file has every tissue.
void check_leaves(const std::vector<std::string>& names) {
  const TemporaryFolder folder;
  write_volume(folder, names);
  const std::string volume = folder / "v.nrrd", tissues = folder / "t.json";
  const auto listed = run_limber({"tissues", volume, "--tissues", tissues, "--frequency", "900e6", "--json"});
  REQUIRE_MESSAGE(listed.exit_code == 0, listed.err);
  const auto json = nlohmann::json::parse(listed.out);
  CHECK_MESSAGE(json["unmatched"].empty(), json["unmatched"].dump());
  CHECK(json["tissues"].size() == names.size());
  for (const char* name : {"v.xml", "v.gprmax.h5", "v.dat"}) {
    const auto run = run_limber({"convert", volume, folder / name, "--tissues", tissues, "--frequency", "900e6"});
    CHECK_MESSAGE(run.exit_code == 0, name, ": ", run.err);
    CHECK_MESSAGE(run.err.find("known for") == run.err.npos, run.err);
  }
  CHECK(count(text_of(folder / "v.xml"), "<Material ") == names.size());
  CHECK(count(text_of(folder / "v_materials.txt"), "#material:") >= names.size());
  const std::string organs = text_of(folder / "v_organs.dat");
  for (const std::string& name : names) CHECK_MESSAGE(organs.find("\t" + name + "\n") != organs.npos, name);
}

}  // namespace

TEST_CASE("convert: every class of TotalSegmentator's other tasks goes to openEMS, gprMax and ICRP slices") {
  check_leaves(names_of(total_segmentator_sub_tasks()));
}

TEST_CASE("convert: every organ of ICRP 110 and of the Visible Human goes to openEMS, gprMax and ICRP slices" *
          doctest::test_suite("slow")) {
  check_leaves(names_of(icrp_110_organs()));
  check_leaves(names_of(visible_human_tissues()));
}

TEST_CASE("convert: every structure of BodyParts3D and the SPL knee goes to openEMS, gprMax and ICRP slices" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_structures.labels.json");
  for (const char* table : {"data/bp3d/body_structures.labels.json", "data/spl/knee.ctbl"}) {
    std::vector<std::string> names;
    for (const limber::Tissue& tissue : limber::read_tissue_table(shared_path(table)).tissues)
      if (tissue.label != 0) names.push_back(tissue.name);
    check_leaves(names);
  }
}

TEST_CASE("convert: ICRP slices have columns for an implant's elements where there is one, and only there") {
  const TemporaryFolder folder;
  write_volume(folder, {"femur_left", "hip_implant"});
  const auto run = run_limber({"convert", folder / "v.nrrd", folder / "v.dat", "--tissues", folder / "t.json"});
  REQUIRE_MESSAGE(run.exit_code == 0, run.err);
  const std::string media = text_of(folder / "v_media.dat");
  CHECK(media.find("\tI\tAl\tTi\tV\tname") != media.npos);
  CHECK(media.find("\t6\t90\t4\ttitanium alloy\n") != media.npos);
  write_volume(folder, {"femur_left"});
  REQUIRE(run_limber({"convert", folder / "v.nrrd", folder / "v.dat", "--tissues", folder / "t.json"}).exit_code == 0);
  CHECK(text_of(folder / "v_media.dat").find("\tI\tname") != std::string::npos);
}
