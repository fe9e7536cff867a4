// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_map.h"

#include <filesystem>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/core/skin/small_body.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

constexpr Label kHip = 3, kFemora = 4, kHyoid = 5;

Tissue named_tissue(Label label, const char* name, TissueKind kind, double value) {
  Tissue tissue;
  tissue.label = label;
  tissue.file_value = value;
  tissue.name = name;
  tissue.kind = kind;
  return tissue;
}

// A pelvis over two thighs, and a small bone whose name belongs to no rig bone.
SmallBody legs() {
  SmallBody body;
  body.volume.grid.size = {56, 16, 72};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  for (int z = 2; z < 70; ++z)
    for (int y = 2; y < 14; ++y)
      for (int x = 2; x < 54; ++x) {
        const double aside = std::abs(std::abs(x - 27.5) - 18);
        if (z >= 46 || aside < 7) body.volume.at({x, y, z}) = kMuscle;
        if (y < 5 || y > 10) continue;
        if (z >= 56 && z < 66 && x > 10 && x < 45) body.volume.at({x, y, z}) = kHip;
        if (z >= 6 && z < 52 && aside < 3) body.volume.at({x, y, z}) = kFemora;
        if (z == 69 && x == 27) body.volume.at({x, y, z}) = kHyoid;
      }
  body.tissues.tissues = {
      named_tissue(kMuscle, "muscle", TissueKind::Muscle, 1), named_tissue(kHip, "Pelvis", TissueKind::Bone, 30),
      named_tissue(kFemora, "Femora", TissueKind::Bone, 40), named_tissue(kHyoid, "thing", TissueKind::Bone, 50)};
  body.armature.bones = {bone_between("Pelvis", -1, {27.5, 7.5, 56}, {27.5, 7.5, 68}),
                         bone_between("LeftThigh", 0, {45.5, 7.5, 54}, {45.5, 7.5, 6}),
                         bone_between("RightThigh", 0, {9.5, 7.5, 54}, {9.5, 7.5, 6})};
  return body;
}

std::vector<MappedLabel> rows_of(const SmallBody& body, const BoneMap& map = {}) {
  const TissueVoxels tissue(body.volume);
  return mapped_labels(split_bones(body.volume, tissue, body.tissues, body.armature, no_progress(), map), body.tissues,
                       body.armature, map);
}

}  // namespace

TEST_CASE("bone map: every label of bone is a row, its sides rows of their own, with all its voxels") {
  const SmallBody body = legs();
  const auto rows = rows_of(body);
  REQUIRE(rows.size() == 4);
  CHECK(rows[0].label == kHip);
  CHECK_FALSE(rows[0].side);
  CHECK(rows[0].bones == std::vector<int>{0});
  CHECK(rows[0].found_by == FoundBy::Name);
  CHECK(rows[1].side == BodySide::Left);
  CHECK(rows[1].bones == std::vector<int>{1});
  CHECK(rows[2].side == BodySide::Right);
  CHECK(rows[2].bones == std::vector<int>{2});
  CHECK(rows[3].label == kHyoid);
  CHECK(rows[3].found_by == FoundBy::Shape);
  for (const Label label : {kHip, kFemora, kHyoid}) {
    std::int64_t voxels = 0;
    for (const MappedLabel& row : rows) voxels += row.label == label ? row.voxels : 0;
    CHECK(voxels == std::count(body.volume.voxels.begin(), body.volume.voxels.end(), label));
  }
}

TEST_CASE("bone map: entries of a row change it alone, by the label's value, and can be taken back") {
  const SmallBody body = legs();
  const Tissue& femora = *body.tissues.find(kFemora);
  const std::string pelvis = "Pelvis", left = "LeftThigh";
  const BoneMap one = with_entry({}, femora, BodySide::Right, &pelvis);
  CHECK(one == BoneMap{{"40@right", "Pelvis"}});
  auto rows = rows_of(body, one);
  CHECK(rows[1].bones == std::vector<int>{1});
  CHECK(rows[2].bones == std::vector<int>{0});
  CHECK(rows[2].found_by == FoundBy::Map);
  // An entry for the whole label replaces the entries for its sides, and an entry for a side replaces the entry for the
  // whole label.
  const BoneMap whole = with_entry(one, femora, {}, &left);
  CHECK(whole == BoneMap{{"40", "LeftThigh"}});
  rows = rows_of(body, whole);
  REQUIRE(rows.size() == 3);
  CHECK(rows[1].bones == std::vector<int>{1});
  CHECK(with_entry(whole, femora, BodySide::Left, &pelvis) ==
        BoneMap{{"40@left", "Pelvis"}, {"40@right", "LeftThigh"}});
  CHECK(with_entry(whole, femora, {}, nullptr).empty());
  CHECK(with_entry(one, femora, BodySide::Right, nullptr).empty());
  CHECK(with_entry({{"Femora", "Pelvis"}}, femora, {}, &left) == BoneMap{{"40", "LeftThigh"}});
}

TEST_CASE("bone map: what names no tissue or no bone is left out, and the rest is used") {
  const SmallBody body = legs();
  const BoneMap map{{"40@left", "LeftThigh"}, {"40@right", "Tail"}, {"99", "Pelvis"},
                    {"Pelvis", "LeftThigh"},  {"thing", "Pelvis"},  {"", "x"}};
  const FittingBoneMap fitting = fitting_bone_map(map, body.tissues, body.armature);
  CHECK(fitting.map == BoneMap{{"40@left", "LeftThigh"}, {"Pelvis", "LeftThigh"}, {"thing", "Pelvis"}});
  CHECK(fitting.left_out == std::vector<std::string>{"", "40@right", "99"});
  CHECK_NOTHROW(rows_of(body, fitting.map));
  // If the name of a label does not say left or right, its two entries for the sides are valid together, and invalid
  // alone.
  CHECK(fitting_bone_map({{"50@left", "LeftThigh"}, {"50@right", "RightThigh"}}, body.tissues, body.armature)
            .left_out.empty());
  CHECK(fitting_bone_map({{"50@left", "LeftThigh"}, {"99", "Pelvis"}}, body.tissues, body.armature).map.empty());
}

TEST_CASE("bone map: a file gives back what was written") {
  const TemporaryFolder folder;
  const BoneMap map{{"40@left", "LeftThigh"}, {"Pelvis \"big\"", "a\\b"}, {"17", "\u00e4"}};
  write_bone_map(map, folder / "map.json");
  CHECK(read_bone_map(folder / "map.json") == map);
  write_bone_map({}, folder / "map.json");
  CHECK(read_bone_map(folder / "map.json").empty());
}
