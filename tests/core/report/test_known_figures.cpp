// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks the numbers in reports against results worked out by hand, and against numpy and scipy.
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/deform/inverse_map.h"
#include "core/report/dice.h"
#include "core/report/report.h"
#include "core/resample/resample.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/bent_tube.h"
#include "tests/support/program.h"
#include "tests/support/random_blobs.h"

using namespace limber;

namespace {

constexpr Label kStays = 2, kTurns = 3;
constexpr double kHalfTurn = std::numbers::pi;

// Two boxes of 8 x 8 x 8 voxels of 1 mm, each on its own bone. The first lies at x = 4 to 11, the second at x = 24 to
// 31. Half a turn about z at x = `axis` takes the second to x = 2 axis - 31 to 2 axis - 24.
struct TwoBoxes {
  LabelVolume volume{{.size = {40, 12, 12}}, ZeroedVector<Label>(40 * 12 * 12)};
  TissueTable tissues;
  Armature rig;
  SkinWeights weights;
  Pose pose;

  TwoBoxes(double axis, TissueKind kind) {
    for (const auto& [label, from] : {std::pair{kStays, 4}, {kTurns, 24}})
      for (int z = 2; z < 10; ++z)
        for (int y = 2; y < 10; ++y)
          for (int x = from; x < from + 8; ++x) volume.at({x, y, z}) = label;
    for (const Label label : {kStays, kTurns})
      tissues.tissues.push_back(
          {.label = label, .file_value = double(label), .name = label == kStays ? "stays" : "turns", .kind = kind});
    rig.bones = {{.name = "Still", .head = {8, 5.5, 5.5}, .tail = {12, 5.5, 5.5}},
                 {.name = "Turning", .parent = 0, .head = {axis, 5.5, 5.5}, .tail = {32, 5.5, 5.5}}};
    const TissueVoxels tissue(volume);
    weights = SkinWeights({"Still", "Turning"}, tissue);
    for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
      SkinWeights::Influences chunk;
      tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
        chunk.push_back(rigid_influence(volume.at(v) == kTurns ? 1 : 0));
      });
      weights.set_chunk(b, chunk);
    }
    pose = rest_pose(rig);
    pose.rotation[1] = glm::angleAxis(kHalfTurn, glm::dvec3(0, 0, 1));
  }
  Posed posed(const ResampleSettings& settings = {.nearest = true, .overlap = true}) const {
    return resample(volume, tissues, rig, weights, pose, Blend::Linear, settings);
  }
};

std::int64_t count(const ZeroedVector<Label>& voxels, Label value) {
  return std::count(voxels.begin(), voxels.end(), value);
}

}  // namespace

TEST_CASE(
    "known figures: a box laid over another shares as many voxels as paper and pencil say, and the map shows which") {
  for (const auto& [axis, slices] : {std::pair{21.5, 0}, {20.0, 3}, {18.5, 6}, {17.5, 8}}) {
    const TwoBoxes boxes(axis, TissueKind::Fat);
    const Posed posed = boxes.posed();
    INFO("axis at ", axis);
    CHECK(posed.report.overlap_voxels == 64 * slices);
    CHECK(posed.report.overlap_by_label[kStays] + posed.report.overlap_by_label[kTurns] == 64 * slices);
    CHECK(posed.report.bone_overlap_voxels == 0);
    CHECK(posed.report.new_hole_voxels == 0);
    CHECK(posed.report.dropped_voxels == 0);
    const VolumeMetrics metrics = compare(boxes.volume, posed.volume, boxes.tissues);
    CHECK(metrics.voxels_before == 1024);
    CHECK(metrics.voxels_after == 1024 - 64 * slices);
    CHECK(metrics.volume_change_percent == doctest::Approx(-6.25 * slices));
    REQUIRE(posed.overlap.size() == posed.volume.voxels.size());
    CHECK(count(posed.overlap, 1) == 64 * slices);
    const Grid& grid = posed.volume.grid;
    for (std::int64_t i = 0; i < grid.voxel_count(); ++i) {
      const double x = grid.origin.x + double(i % grid.size.x);  // x of the voxel's centre; the grid is axis-aligned
      if (posed.overlap[i]) CHECK((x >= 12 - slices && x <= 11));
    }
  }
}

TEST_CASE("known figures: bone laid over bone is counted as such") {
  const TwoBoxes boxes(20, TissueKind::Bone);
  const Posed posed = boxes.posed();
  CHECK(posed.report.bone_overlap_voxels == 64 * 3);
  CHECK(count(posed.overlap, 2) == 64 * 3);
  REQUIRE(posed.report.bones.size() == 2);
  for (const auto& bone : posed.report.bones) CHECK(bone.rigid_residual_mm < 1e-4);
}

TEST_CASE("known figures: a bone's residual is how far a voxel is from where the bone takes it") {
  const TwoBoxes boxes(17.5, TissueKind::Bone);
  const TissueVoxels tissue(boxes.volume);
  LabelSet is_bone(65536, 0);
  is_bone[kStays] = is_bone[kTurns] = 1;
  const std::vector<RigidTransform> motions = posed_from_rest(boxes.rig, boxes.pose);
  const PosedLattice lattice(boxes.volume, tissue, boxes.weights, motions, Blend::Linear, glm::dvec3(1));
  const RigidBones bones(lattice, boxes.weights, is_bone, motions);
  const glm::dvec3 rest(27, 4, 6), turned(35 - 27, 11 - 4, 6), base(lattice.output().base);
  CHECK(bones.residual(1, rest, turned - base) < 1e-9);
  CHECK(bones.residual(1, rest, turned - base + glm::dvec3(3, -4, 12)) == doctest::Approx(13));
  CHECK(bones.residual(0, rest, turned - base) == doctest::Approx(std::hypot(19.0, 3.0)));
}

TEST_CASE("known figures: a torn-off piece is one more component, a hole inside is enclosed air, and Dice is by hand") {
  TwoBoxes boxes(20, TissueKind::Fat);
  LabelVolume after = boxes.volume;
  for (int y = 2; y < 10; ++y)
    for (int z = 2; z < 10; ++z)
      for (const int x : {27, 28}) after.at({x, y, z}) = 0;  // cuts the second box into two parts of 3 slices each
  after.at({8, 5, 5}) = after.at({8, 6, 5}) = 0;             // a hole in the first box
  const VolumeMetrics metrics = compare(boxes.volume, after, boxes.tissues);
  REQUIRE(metrics.tissues.size() == 2);
  CHECK(metrics.tissues[0].components_after == 1);
  CHECK(metrics.tissues[1].components_before == 1);
  CHECK(metrics.tissues[1].components_after == 2);
  CHECK(metrics.trapped_air_voxels == 2);
  const std::vector<double> dice = dice_by_label(boxes.volume, after);
  CHECK(dice[kStays] == doctest::Approx(2.0 * 510 / (512 + 510)));
  CHECK(dice[kTurns] == doctest::Approx(2.0 * 384 / (512 + 384)));
  CHECK(dice[7] == 0);
}

TEST_CASE(
    "known figures: numpy and scipy find the same voxels, pieces, surface, enclosed air, Dice and bone residuals" *
    doctest::test_suite("slow")) {
  if (test::run_program("/usr/bin/python3", {"-c", "import scipy.ndimage, scipy.spatial"}).exit_code != 0) {
    MESSAGE("SKIPPED: /usr/bin/python3 has no scipy (Debian's python3-scipy)");
    return;
  }
  const test::TemporaryFolder folder;
  const auto ask = [&](std::vector<std::string> files) {
    files.insert(files.begin(), std::string(LIMBER_SOURCE_DIR) + "/tests/independent/volume_figures.py");
    const auto run = test::run_program("/usr/bin/python3", files);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    std::map<std::pair<std::string, int>, std::vector<double>> figures;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string name;
      int label = 0;
      words >> name >> label;
      for (double value; words >> value;) figures[{name, label}].push_back(value);
    }
    return figures;
  };
  const auto check = [&](const LabelVolume& before, const LabelVolume& after, const TissueTable& tissues,
                         const auto& theirs) {
    const VolumeMetrics ours = compare(before, after, tissues);
    const LabelCensus census[] = {take_census(before), take_census(after)};
    for (const TissueChange& tissue : ours.tissues) {
      INFO("label ", tissue.label);
      CHECK(theirs.at({"voxels", tissue.label}) ==
            std::vector<double>{double(tissue.voxels_before), double(tissue.voxels_after)});
      CHECK(theirs.at({"components", tissue.label}) ==
            std::vector<double>{double(tissue.components_before), double(tissue.components_after)});
      CHECK(theirs.at({"surface", tissue.label}) ==
            std::vector<double>{double(census[0].surface_voxels[tissue.label]),
                                double(census[1].surface_voxels[tissue.label])});
    }
    CHECK(theirs.at({"enclosed", 0}) ==
          std::vector<double>{double(ours.enclosed_air_before), double(ours.enclosed_air_after)});
  };

  std::mt19937 random(7);
  TissueTable table;
  for (Label label = 1; label < 6; ++label)
    table.tissues.push_back({.label = label, .file_value = double(label), .name = std::to_string(label)});
  std::vector<LabelVolume> blobs;
  for (int which = 0; which < 2; ++which) {
    LabelVolume volume = test::random_blobs(random, {40, 30, 24}, 400, 5);
    write_volume(volume, folder / (which ? "after.nrrd" : "before.nrrd"), table);
    blobs.push_back(std::move(volume));
  }
  auto theirs = ask({folder / "before.nrrd", folder / "after.nrrd"});
  check(blobs[0], blobs[1], table, theirs);
  const std::vector<double> dice = dice_by_label(blobs[0], blobs[1]);
  for (Label label = 1; label < 6; ++label) CHECK(theirs.at({"dice", label}).at(0) == doctest::Approx(dice[label]));

  TwoBoxes boxes(20, TissueKind::Bone);
  boxes.pose.rotation[1] = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -1)));
  const Posed posed = boxes.posed({.displacement = true});
  write_volume(boxes.volume, folder / "before.nrrd", boxes.tissues);
  write_volume(posed.volume, folder / "after.nrrd", boxes.tissues);
  write_vector_volume(posed.volume.grid, posed.displacement, folder / "field.nrrd");
  theirs = ask({folder / "before.nrrd", folder / "after.nrrd", folder / "field.nrrd"});
  check(boxes.volume, posed.volume, boxes.tissues, theirs);
  for (const Label label : {kStays, kTurns}) CHECK(theirs.at({"residual", label}).at(0) < 1e-4);
  for (const auto& bone : posed.report.bones) CHECK(bone.rigid_residual_mm < 1e-4);
}
