// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/tissue_volumes.h"

#include <cmath>
#include <set>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/report/metrics.h"
#include "core/resample/resample.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

constexpr Label kSkin = 1, kFat = 2, kMuscle = 3, kVessel = 4, kBone = 5;

struct Sets {
  LabelSet soft = LabelSet(65536, 1), skin = LabelSet(65536, 0);
  Sets() {
    soft[kBone] = 0;
    skin[kSkin] = 1;
  }
};

// A ball of muscle around bone, in fat, in skin of one voxel.
LabelVolume ball(int size = 36) {
  LabelVolume volume;
  volume.grid.size = glm::ivec3(size);
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  const double middle = (size - 1) / 2.0, radius = middle - 3;
  glm::ivec3 v;
  for (v.z = 0; v.z < size; ++v.z)
    for (v.y = 0; v.y < size; ++v.y)
      for (v.x = 0; v.x < size; ++v.x) {
        const double r = glm::length(glm::dvec3(v) - middle);
        if (r <= radius) volume.at(v) = r < radius / 3 ? kBone : r < radius * 0.7 ? kMuscle : kFat;
      }
  const LabelVolume bare = volume;
  for (v.z = 0; v.z < size; ++v.z)
    for (v.y = 0; v.y < size; ++v.y)
      for (v.x = 0; v.x < size; ++v.x)
        if (bare.at(v) && touches_air(bare, v)) volume.at(v) = kSkin;
  return volume;
}

std::int64_t count(const LabelVolume& volume, Label label) {
  return std::count(volume.voxels.begin(), volume.voxels.end(), label);
}

std::map<Label, std::int64_t> soft_counts(const LabelVolume& volume) {
  return {{kSkin, count(volume, kSkin)},
          {kFat, count(volume, kFat)},
          {kMuscle, count(volume, kMuscle)},
          {kVessel, count(volume, kVessel)}};
}

// Returns a move for every voxel at a border, with a cost that depends on (x + y) % 4.
std::vector<BorderMove> border_moves(const LabelVolume& volume) {
  const Sets sets;
  std::vector<BorderMove> moves;
  const glm::ivec3 size = volume.grid.size;
  glm::ivec3 v;
  for (v.z = 0; v.z < size.z; ++v.z)
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) {
        const Label own = volume.at(v);
        if (own == 0 || !sets.soft[own]) continue;
        std::set<Label> others;
        for (int axis = 0; axis < 3; ++axis)
          for (int side : {-1, 1}) {
            glm::ivec3 beside = v;
            beside[axis] += side;
            if (const Label label = volume.at_or_air(beside); label != own && sets.soft[label]) others.insert(label);
          }
        for (const Label other : others)
          moves.push_back({volume.grid.index(v), own, other, 0.1f * float((v.x + v.y) % 4)});
      }
  return moves;
}

// Checks that only skin touches air, that tissues keep their number of parts, that no air is enclosed, and that bone is
// unchanged.
void check_sound(const LabelVolume& before, const LabelVolume& after) {
  const LabelCensus was = take_census(before), is = take_census(after);
  for (Label label = 1; label <= kBone; ++label) {
    CHECK(is.components[label] == was.components[label]);
    if (label != kSkin) CHECK(is.surface_voxels[label] == was.surface_voxels[label]);
  }
  CHECK(is.enclosed_air_voxels == was.enclosed_air_voxels);
  for (size_t i = 0; i < before.voxels.size(); ++i)
    CHECK_MESSAGE((before.voxels[i] == kBone) == (after.voxels[i] == kBone), i);
}

TissueVolumes keep(LabelVolume& volume, const std::map<Label, std::int64_t>& wanted) {
  const Sets sets;
  return keep_tissue_volumes(volume, wanted, border_moves(volume), sets.soft, sets.skin);
}

}  // namespace

TEST_CASE("tissue volumes: a border moves by exactly the voxels that are wanted, the least sure ones first") {
  const LabelVolume before = ball();
  auto wanted = soft_counts(before);
  wanted[kMuscle] += 60;
  wanted[kFat] -= 60;
  LabelVolume after = before;
  const TissueVolumes kept = keep(after, wanted);
  CHECK(kept.changed == 60);
  CHECK(kept.missing.empty());
  CHECK(soft_counts(after) == wanted);
  check_sound(before, after);
  for (std::int64_t i = 0; i < std::ssize(before.voxels); ++i)
    if (before.voxels[i] != after.voxels[i]) CHECK((i % 36 + i / 36 % 36) % 4 == 0);
}

TEST_CASE("tissue volumes: where all is as wanted nothing changes") {
  const LabelVolume before = ball();
  LabelVolume after = before;
  CHECK(keep(after, soft_counts(before)).changed == 0);
  CHECK(after.voxels == before.voxels);
}

TEST_CASE("tissue volumes: tissues that do not touch exchange through the one between them") {
  const LabelVolume before = ball();
  auto wanted = soft_counts(before);
  wanted[kMuscle] += 40;
  wanted[kFat] -= 10;
  LabelVolume after = before;
  CHECK(keep(after, wanted).missing.empty());  // 30 voxels come from air, handed on through skin and fat
  CHECK(soft_counts(after) == wanted);
  check_sound(before, after);
}

TEST_CASE("tissue volumes: a body grows into air and shrinks from it beneath skin that keeps its thickness") {
  const LabelVolume before = ball();
  for (const int change : {-150, 150}) {
    CAPTURE(change);
    auto wanted = soft_counts(before);
    wanted[kFat] += change;
    LabelVolume after = before;
    const TissueVolumes kept = keep(after, wanted);
    CHECK(kept.missing.empty());
    CHECK(soft_counts(after) == wanted);
    check_sound(before, after);
  }
}

TEST_CASE("tissue volumes: a strand is not torn, and what could not be had is told") {
  LabelVolume before = ball(48);
  for (int z = 8; z < 40; ++z)
    for (int y = 36; y < 38; ++y)
      for (int x = 23; x < 25; ++x)
        if (before.at({x, y, z}) == kFat || before.at({x, y, z}) == kMuscle) before.at({x, y, z}) = kVessel;
  const std::int64_t strand = count(before, kVessel);
  REQUIRE(strand >= 100);
  auto wanted = soft_counts(before);
  wanted[kVessel] = 0;
  wanted[kFat] += strand;
  LabelVolume after = before;
  const TissueVolumes kept = keep(after, wanted);
  CHECK(kept.missing.at(kVessel) == -count(after, kVessel));
  CHECK(kept.missing.at(kFat) == count(after, kVessel));
  check_sound(before, after);
}

TEST_CASE(
    "mass-exact: soft tissues of a bent limb get their rest volumes with every blend, bones, parts and the closed skin "
    "stay") {
  const test::BentTube tube = test::bent_tube({}, 120);
  const auto soft_share_off = [&](const LabelVolume& volume) {
    double most = 0;
    for (const Label label : {test::kSkin, test::kFat})
      most = std::max(most, std::abs(double(count(volume, label)) / double(count(tube.volume, label)) - 1));
    return most;
  };
  for (const Method& method : {Method(Blend::Linear), Method(Blend::DualQuaternion)}) {
    const Posed plain = resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(25), method);
    const Posed exact =
        resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(25), method, {.mass_exact = true});
    CHECK(soft_share_off(plain.volume) > 0.001);
    CHECK(soft_share_off(exact.volume) < 0.001);
    REQUIRE(exact.report.mass_exact);
    CHECK(exact.report.mass_exact->tissues.at(test::kFat).after == count(exact.volume, test::kFat));
    const LabelCensus was = take_census(plain.volume), is = take_census(exact.volume);
    CHECK(is.components == was.components);
    CHECK(is.enclosed_air_voxels == was.enclosed_air_voxels);
    CHECK(is.surface_voxels[test::kFat] <= was.surface_voxels[test::kFat]);
    std::int64_t changed = 0;
    for (size_t i = 0; i < plain.volume.voxels.size(); ++i) {
      changed += plain.volume.voxels[i] != exact.volume.voxels[i];
      CHECK_MESSAGE((plain.volume.voxels[i] == test::kBone) == (exact.volume.voxels[i] == test::kBone), i);
    }
    CHECK(changed > 0);
    CHECK(changed <= exact.report.mass_exact->changed_voxels);
  }
}

TEST_CASE("mass-exact: the same for 1 and 2 threads, nothing at rest, refused where too much would be made up") {
  const test::BentTube tube = test::bent_tube({}, 120);
  const auto posed = [&](double degrees, int threads) {
    const ThreadCount count(threads);
    return resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(degrees), Blend::Linear,
                    {.mass_exact = true})
        .volume.voxels;
  };
  CHECK(posed(25, 1) == posed(25, 2));
  CHECK(posed(0, 1) == tube.volume.voxels);
  // A body that turns as a whole only loses voxels by the grid's rounding, and gets them back.
  Pose turned = rest_pose(tube.rig);
  turned.rotation[0] = glm::angleAxis(0.5, glm::normalize(glm::dvec3(1, 2, 3)));
  const LabelVolume whole =
      resample(tube.volume, tube.tissues, tube.rig, tube.weights, turned, Blend::Linear, {.mass_exact = true}).volume;
  for (const Label label : {test::kSkin, test::kFat})
    CHECK(std::abs(double(count(whole, label)) / double(count(tube.volume, label)) - 1) < 0.001);
  CHECK_THROWS_WITH_AS(posed(120, 2), doctest::Contains("mass-exact"), Error);
}
