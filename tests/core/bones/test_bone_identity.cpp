// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_identity.h"

#include <map>
#include <string>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/bones/bone_parts.h"
#include "core/bones/unsure_bones.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
Tissue named_tissue(Label label, const char* name, TissueKind kind) {
  Tissue tissue;
  tissue.label = label;
  tissue.file_value = label;
  tissue.name = name;
  tissue.kind = kind;
  return tissue;
}

// A pelvis, 40 voxels wide, with a thigh under each end. The hip bones reach down beside the heads of the thighs, so
// that distance alone would assign them to the thighs.
constexpr Label kHip = 3, kFemora = 4, kMarrow = 5;
SmallBody hips(bool one_label_each_side = false) {
  SmallBody body;
  body.volume.grid.size = {56, 16, 72};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  for (int z = 2; z < 70; ++z)
    for (int y = 2; y < 14; ++y)
      for (int x = 2; x < 54; ++x) {
        const bool leg = std::abs(std::abs(x - 27.5) - 18) < 7;
        if (z >= 46 || leg) body.volume.at({x, y, z}) = kMuscle;
        const bool in_plane = y >= 5 && y < 11;
        if (in_plane && z >= 42 && z < 62 && std::abs(std::abs(x - 27.5) - 11) < 4) body.volume.at({x, y, z}) = kHip;
        if (in_plane && z >= 6 && z < 56 && std::abs(std::abs(x - 27.5) - 18) < 3) body.volume.at({x, y, z}) = kFemora;
        if (y >= 7 && y < 9 && z >= 10 && z < 40 && std::abs(std::abs(x - 27.5) - 18) < 1.1)
          body.volume.at({x, y, z}) = kMarrow;
      }
  body.tissues.tissues = {named_tissue(kMuscle, "muscle", TissueKind::Muscle),
                          named_tissue(kHip, one_label_each_side ? "hip_left" : "Pelvis, cortical", TissueKind::Bone),
                          named_tissue(kFemora, "Femora, cortical", TissueKind::Bone),
                          named_tissue(kMarrow, "marrow", TissueKind::Marrow)};
  body.armature.bones = {bone_between("Pelvis", -1, {27.5, 7.5, 56}, {27.5, 7.5, 68}),
                         bone_between("LeftThigh", 0, {45.5, 7.5, 54}, {45.5, 7.5, 6}),
                         bone_between("RightThigh", 0, {9.5, 7.5, 54}, {9.5, 7.5, 6})};
  return body;
}

// Counts voxels by label and rig bone.
std::map<std::pair<Label, std::string>, std::int64_t> counts_of(const SmallBody& body, const BoneMap& map = {}) {
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature, no_progress(), map);
  std::map<std::pair<Label, std::string>, std::int64_t> counts;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (parts.part_of[place])
      ++counts[{body.volume.at(v), body.armature.bones[parts.parts[parts.part_of[place] - 1].bone].name}];
  });
  return counts;
}

std::int64_t voxels_of(const SmallBody& body, Label label) {
  return std::count(body.volume.voxels.begin(), body.volume.voxels.end(), label);
}
}  // namespace

TEST_CASE("bone identity: hip bones beside the heads of the thighs follow the pelvis by their name") {
  const SmallBody body = hips();
  const auto counts = counts_of(body);
  CHECK(counts.at({kHip, "Pelvis"}) == voxels_of(body, kHip));
  CHECK(counts.at({kFemora, "LeftThigh"}) == voxels_of(body, kFemora) / 2);
  CHECK(counts.at({kFemora, "RightThigh"}) == voxels_of(body, kFemora) / 2);
}

TEST_CASE("bone identity: marrow without a name follows the bone that it lies in") {
  const auto counts = counts_of(hips());
  CHECK(counts.at({kMarrow, "LeftThigh"}) == counts.at({kMarrow, "RightThigh"}));
  CHECK_FALSE(counts.contains({kMarrow, "Pelvis"}));
}

TEST_CASE("bone identity: left and right in one label part by the rig even where a bridge of bone joins them") {
  SmallBody body = hips();
  // A bridge of bone from thigh to thigh must be divided in its middle.
  for (int x = 9; x < 46; ++x) body.volume.at({x, 8, 20}) = kFemora;
  const auto counts = counts_of(body);
  CHECK(counts.at({kFemora, "LeftThigh"}) == counts.at({kFemora, "RightThigh"}) - (voxels_of(body, kFemora) & 1));
}

TEST_CASE("bone identity: the user's map counts before the name, on each side") {
  const SmallBody body = hips();
  const auto counts = counts_of(body, {{"Pelvis, cortical@left", "LeftThigh"}});
  CHECK(counts.at({kHip, "LeftThigh"}) == voxels_of(body, kHip) / 2);
  CHECK(counts.at({kHip, "Pelvis"}) == voxels_of(body, kHip) / 2);
  CHECK(counts_of(body, {{"4", "Pelvis"}}).at({kFemora, "Pelvis"}) == voxels_of(body, kFemora));
}

TEST_CASE("bone identity: what a map says of nothing that is there is refused with the way to mend it") {
  const SmallBody body = hips();
  CHECK_THROWS_AS(counts_of(body, {{"Pelvis, cortical", "Tail"}}), Error);
  CHECK_THROWS_AS(counts_of(body, {{"Ribs", "Pelvis"}}), Error);
  CHECK_THROWS_AS(counts_of(body, {{"muscle", "Pelvis"}}), Error);
  // The name of the marrow does not say left or right, so an entry for one side needs an entry for the other.
  CHECK_THROWS_AS(counts_of(body, {{"marrow@left", "LeftThigh"}}), Error);
  CHECK(counts_of(body, {{"marrow@left", "LeftThigh"}, {"marrow@right", "Pelvis"}}).contains({kMarrow, "Pelvis"}));
}

TEST_CASE("bone identity: each label's table says how it was found") {
  const SmallBody body = hips();
  const TissueVoxels tissue(body.volume);
  const BoneParts parts =
      split_bones(body.volume, tissue, body.tissues, body.armature, no_progress(), {{"3", "Pelvis"}});
  std::map<Label, FoundBy> found;
  for (const auto& identity : parts.identities) found[identity.label] = identity.found_by;
  CHECK(found == std::map<Label, FoundBy>{{kHip, FoundBy::Map}, {kFemora, FoundBy::Name}, {kMarrow, FoundBy::Kind}});
}

TEST_CASE("bone identity: a bone that the rig lacks follows the next one towards the trunk, and a lost one is told") {
  SmallBody body = hips();
  body.tissues.find(kHip)->name = "tibia_left";  // a tibia, on a rig without a shank
  CHECK(counts_of(body).at({kHip, "LeftThigh"}) == voxels_of(body, kHip));
  body.armature.bones = {bone_between("LeftThigh", -1, {45.5, 7.5, 54}, {45.5, 7.5, 6})};
  body.tissues.find(kHip)->name = "skull";
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  const auto lines = unsure_bones(parts, body.tissues, body.armature);
  // The right femur is unsure too: this rig has no right thigh.
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].find("skull") != std::string::npos);
  CHECK(lines[1].find("Femora") != std::string::npos);
}

TEST_CASE("bone identity: a rib on a rig with two thoraces follows the one it is attached to, whole") {
  SmallBody body;
  body.volume.grid.size = {40, 12, 60};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), kMuscle);
  // The rib runs from the upper thorax down and outwards, so that most of it lies nearer to the lower thorax.
  for (int x = 8; x < 38; ++x)
    for (int z = 0; z < 3; ++z)
      for (int y = 4; y < 8; ++y) body.volume.at({x, y, std::max(2, 34 - (x - 8)) + z}) = kBone;
  body.tissues.tissues = {named_tissue(kMuscle, "muscle", TissueKind::Muscle),
                          named_tissue(kBone, "Left fifth rib", TissueKind::Bone)};
  body.armature.bones = {bone_between("Pelvis", -1, {6, 6, 0}, {6, 6, 4}),
                         bone_between("ThoraxLower", 0, {6, 6, 4}, {6, 6, 30}),
                         bone_between("ThoraxUpper", 1, {6, 6, 30}, {6, 6, 56})};
  const auto counts = counts_of(body);
  CHECK(counts.size() == 1);
  CHECK(counts.at({kBone, "ThoraxUpper"}) == voxels_of(body, kBone));
}

TEST_CASE("bone map: a file that says a key twice, nests or names no bone is refused") {
  CHECK(parse_bone_map("{\"Ribs@left\": \"Thorax\"}", "map.json") == BoneMap{{"Ribs@left", "Thorax"}});
  CHECK(parse_bone_map("{}", "map.json").empty());
  for (const char* text : {"", "[]", "{\"a\": 1}", "{\"a\": \"b\", \"a\": \"c\"}", "{\"a\": {\"b\": \"c\"}}",
                           "{\"a\": [\"b\"]}", "{\"a\"", "null"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse_bone_map(text, "map.json"), Error);
  }
}
