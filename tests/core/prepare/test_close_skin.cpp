// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/close_skin.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/prepare/prepare.h"
#include "core/report/metrics.h"
#include "core/resample/air_pockets.h"
#include "core/resample/resample.h"
#include "core/volume/outside_air.h"
#include "tests/support/random_bodies.h"

using namespace limber;

namespace {

constexpr Label kSkin = 1, kFlesh = 2, kUpper = 3, kLower = 4, kLegSkin = 5, kNail = 6;

TissueTable table(bool two_skins = false) {
  TissueTable tissues;
  const auto add = [&](Label label, const char* name, TissueKind kind) {
    Tissue tissue;
    tissue.label = label;
    tissue.file_value = label;
    tissue.name = name;
    tissue.kind = kind;
    tissue.priority = is_bone(kind) ? 2 : kind == TissueKind::Skin ? 0 : 1;
    tissues.tissues.push_back(tissue);
  };
  add(kSkin, "skin", TissueKind::Skin);
  add(kFlesh, "muscle", TissueKind::Muscle);
  add(kUpper, "humerus", TissueKind::Bone);
  add(kLower, "ulna", TissueKind::Bone);
  if (two_skins) add(kLegSkin, "skin of the other end", TissueKind::Skin);
  add(kNail, "nail", TissueKind::Nail);
  return tissues;
}

template <class Body>
void for_each_voxel(const glm::ivec3& size, const Body& body) {
  glm::ivec3 v;
  for (v.z = 0; v.z < size.z; ++v.z)
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) body(v);
}

// Makes a limb along z in slices of 6 mm whose thickness changes from slice to slice. Each slice has its own ring of
// skin, but the steps between slices have none. Inside are two bones and a hollow of air.
LabelVolume sliced_limb() {
  LabelVolume limb{{{60, 60, 40}, {2, 2, 6}, {-60, -60, 0}, glm::dmat3(1)}, {}};
  limb.voxels = ZeroedVector<Label>(limb.grid.voxel_count());
  const auto inside = [&](const glm::ivec3& v) {
    const glm::dvec3 p = world_from_voxel(limb.grid) * glm::dvec3(v);
    const double ends = std::min(p.z - 12, 216 - p.z);
    const double radius = std::min(30 + 5 * std::sin(p.z / 18), std::sqrt(std::max(0.0, 60 * ends)));
    return ends > 0 && std::hypot(p.x, p.y) < radius;
  };
  for_each_voxel(limb.grid.size, [&](const glm::ivec3& v) {
    if (!inside(v)) return;
    const glm::dvec3 p = world_from_voxel(limb.grid) * glm::dvec3(v);
    bool at_ring = false;
    for (const glm::ivec3& step :
         {glm::ivec3(1, 0, 0), glm::ivec3(-1, 0, 0), glm::ivec3(0, 1, 0), glm::ivec3(0, -1, 0)})
      at_ring |= !inside(v + step);
    Label& label = limb.at(v);
    label = at_ring ? kSkin : kFlesh;
    if (std::hypot(p.x, p.y) < 8) label = p.z > 30 && p.z < 108 ? kUpper : p.z > 120 && p.z < 198 ? kLower : label;
    if (std::abs(p.x - 16) < 5 && std::abs(p.y) < 5 && p.z > 60 && p.z < 90) label = 0;
  });
  return limb;
}

std::int64_t count(const LabelVolume& volume, Label label) {
  return std::count(volume.voxels.begin(), volume.voxels.end(), label);
}

// Counts the faces of flesh, bone and skin towards outside air, directly by the definition: air that is connected
// through faces to the volume's border.
struct Bare {
  std::int64_t flesh = 0, bone = 0, skin = 0;
};
Bare bare(const LabelVolume& volume) {
  std::vector<bool> inner(volume.voxels.size(), false);
  for (const AirPocket& pocket : air_pockets(volume))
    for (const glm::ivec3& v : pocket) inner[volume.grid.index(v)] = true;
  Bare found;
  for_each_voxel(volume.grid.size, [&](const glm::ivec3& v) {
    const Label label = volume.at(v);
    if (label == 0) return;
    for (const glm::ivec3& step : kFaceNeighbours) {
      const glm::ivec3 beside = v + step;
      if (!volume.grid.contains(beside) || volume.at(beside) || inner[volume.grid.index(beside)]) continue;
      ++(label == kFlesh ? found.flesh : label == kUpper || label == kLower ? found.bone : found.skin);
    }
  });
  return found;
}

}  // namespace

TEST_CASE("outside air: a hollow is inside, and so is a pipe that a side of the volume cuts") {
  LabelVolume volume{{{9, 9, 9}, glm::dvec3(1), glm::dvec3(0), glm::dmat3(1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  for_each_voxel(volume.grid.size, [&](const glm::ivec3& v) {
    const bool in_neck = v.x >= 2 && v.x <= 6 && v.y >= 2 && v.y <= 6 && v.z >= 3;
    if (in_neck && !(v.x == 4 && v.y == 4)) volume.at(v) = kFlesh;
    if (v == glm::ivec3(4, 4, 3)) volume.at(v) = kFlesh;
  });
  const auto outside = outside_air(volume);
  CHECK(outside[volume.grid.index({0, 4, 4})]);
  CHECK_FALSE(outside[volume.grid.index({4, 4, 8})]);
  CHECK_FALSE(outside[volume.grid.index({4, 4, 4})]);
  volume.at({4, 4, 3}) = 0;  // opens the other end of the pipe
  CHECK(outside_air(volume)[volume.grid.index({4, 4, 8})]);
}

TEST_CASE(
    "close skin: no flesh but skin faces outside air, bones keep their labels and hollows their air, inward and "
    "outward") {
  const LabelVolume limb = sliced_limb();
  REQUIRE(bare(limb).flesh > 500);
  for (const SkinGrowth growth : {SkinGrowth::Inward, SkinGrowth::Outward}) {
    const ClosedSkin closed = close_skin(limb, table(), growth);
    CHECK(bare(closed.volume).flesh == 0);
    CHECK_FALSE(closed.is_padded);
    std::int64_t changed = 0, wrong = 0;
    for (size_t i = 0; i < limb.voxels.size(); ++i) {
      if (closed.volume.voxels[i] == limb.voxels[i]) continue;
      ++changed;
      wrong += closed.volume.voxels[i] != kSkin || limb.voxels[i] != (growth == SkinGrowth::Inward ? kFlesh : 0);
    }
    CHECK(wrong == 0);
    CHECK(changed == closed.changed_voxels);
    if (growth == SkinGrowth::Inward) CHECK(closed.covered[kFlesh] == changed);
    std::int64_t hollow_before = 0, hollow_after = 0;
    for (const AirPocket& pocket : air_pockets(limb)) hollow_before += std::ssize(pocket);
    for (const AirPocket& pocket : air_pockets(closed.volume)) hollow_after += std::ssize(pocket);
    CHECK(hollow_before > 0);
    CHECK(hollow_after == hollow_before + closed.enclosed_voxels);
    CHECK(close_skin(closed.volume, table(), growth).changed_voxels == 0);
    for (int threads : {1, 2, 4}) {
      ThreadCount limit(threads);
      CHECK(close_skin(limb, table(), growth).volume.voxels == closed.volume.voxels);
    }
  }
}

TEST_CASE("close skin: a closed skin stays closed when the limb bends, and an open one does not become so") {
  const LabelVolume limb = sliced_limb();
  Armature rig;
  rig.bones = {{"UpperArm", -1, {0, 0, 20}, {0, 0, 114}}, {"Forearm", 0, {0, 0, 114}, {0, 0, 208}}};
  Pose pose = rest_pose(rig);
  pose.rotation[1] = glm::angleAxis(glm::radians(60.0), glm::dvec3(1, 0, 0));
  const auto share_of_skin = [&](const LabelVolume& volume) {
    const SkinWeights weights = diffuse_heat(volume, table(), rig);
    const Posed posed = resample(volume, table(), rig, weights, pose, Blend::Mixed);
    const Bare found = bare(posed.volume);
    return double(found.skin) / double(found.skin + found.flesh + found.bone);
  };
  CHECK(share_of_skin(close_skin(limb, table(), SkinGrowth::Inward).volume) == 1);
  CHECK(share_of_skin(close_skin(limb, table(), SkinGrowth::Outward).volume) == 1);
  CHECK(share_of_skin(limb) < 0.95);
}

TEST_CASE("close skin: at the volume's border a cut stays open, and what only touches it is closed in a grown volume") {
  // A ball touches the low side of z. Beside it a post passes through the whole volume. Neither has skin.
  LabelVolume volume{{{40, 20, 20}, glm::dvec3(2), glm::dvec3(5, 6, 7), glm::dmat3(1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  for_each_voxel(volume.grid.size, [&](const glm::ivec3& v) {
    if (glm::length(glm::dvec3(v) - glm::dvec3(10, 10, 7)) < 7.6) volume.at(v) = kFlesh;
    if (glm::length(glm::dvec2(v) - glm::dvec2(30, 10)) < 6) volume.at(v) = kFlesh;
  });
  const ClosedSkin outward = close_skin(volume, table(), SkinGrowth::Outward),
                   inward = close_skin(volume, table(), SkinGrowth::Inward);
  CHECK(outward.is_padded);
  CHECK(outward.volume.grid.size == volume.grid.size + 2);
  CHECK(world_from_voxel(outward.volume.grid) * glm::dvec3(1) == world_from_voxel(volume.grid) * glm::dvec3(0));
  CHECK(outward.volume.at({11, 11, 0}) == kSkin);
  CHECK(outward.volume.at({31, 11, 0}) == 0);
  CHECK(outward.volume.at({31, 11, 1}) == kFlesh);
  CHECK(outward.cut[4] > 50);
  CHECK(outward.cut[4] == outward.cut[5]);
  CHECK(outward.cut[0] + outward.cut[1] + outward.cut[2] + outward.cut[3] == 0);
  CHECK_FALSE(inward.is_padded);
  CHECK(inward.volume.at({10, 10, 0}) == kSkin);
  CHECK(inward.volume.at({30, 10, 0}) == kFlesh);
  // With a layer of air around the body, nothing is cut off by the border, so the ends of the post get skin too.
  const ClosedSkin padded = close_skin(pad(volume, 1), table(), SkinGrowth::Inward);
  CHECK(padded.volume.at({31, 11, 1}) == kSkin);
  CHECK(padded.cut == std::array<std::int64_t, 6>{});
  // Where bone touches the border, the body always counts as cut off by it.
  volume.at({10, 10, 0}) = kUpper;
  CHECK_FALSE(close_skin(volume, table(), SkinGrowth::Outward).is_padded);
}

TEST_CASE("close skin: bone at the air stays bone inward and is covered outward, and nails stay as they are") {
  LabelVolume limb = sliced_limb();
  for_each_voxel(limb.grid.size, [&](const glm::ivec3& v) {
    if (limb.at(v) == kFlesh && v.z == 3 && v.x > 29) limb.at(v) = kUpper;
    if (limb.at(v) == kFlesh && v.z == 3) limb.at(v) = kNail;
  });
  const ClosedSkin inward = close_skin(limb, table(), SkinGrowth::Inward),
                   outward = close_skin(limb, table(), SkinGrowth::Outward);
  CHECK(inward.bare_bone_voxels > 0);
  CHECK(bare(inward.volume).bone > 0);
  CHECK(bare(outward.volume).bone == 0);
  CHECK(outward.covered[kUpper] == inward.bare_bone_voxels);
  for (const Label label : {kUpper, kLower, kNail}) {
    CHECK(count(inward.volume, label) == count(limb, label));
    CHECK(count(outward.volume, label) == count(limb, label));
  }
  CHECK(outward.covered[kNail] == 0);
}

TEST_CASE("close skin: new skin is like the skin nearest to it, or as it is told, and no skin at all is an error") {
  LabelVolume limb = sliced_limb();
  for_each_voxel(limb.grid.size, [&](const glm::ivec3& v) {
    if (limb.at(v) == kSkin && v.z > 20) limb.at(v) = kLegSkin;
  });
  for (const SkinGrowth growth : {SkinGrowth::Inward, SkinGrowth::Outward}) {
    const ClosedSkin closed = close_skin(limb, table(true), growth);
    std::int64_t wrong = 0;
    for_each_voxel(limb.grid.size, [&](const glm::ivec3& v) {
      if (closed.volume.at(v) != limb.at(v) && std::abs(v.z - 20) > 2)
        wrong += closed.volume.at(v) != (v.z > 20 ? kLegSkin : kSkin);
    });
    CHECK(wrong == 0);
    const ClosedSkin told = close_skin(limb, table(true), growth, Label{9});
    CHECK(count(told.volume, 9) == closed.changed_voxels);  // skin that was there before keeps its label
  }
  TissueTable without = table();
  std::erase_if(without.tissues, [](const Tissue& tissue) { return tissue.kind == TissueKind::Skin; });
  CHECK_THROWS_AS(close_skin(limb, without, SkinGrowth::Inward), Error);
  CHECK(close_skin(limb, without, SkinGrowth::Inward, kSkin).changed_voxels > 0);
}

TEST_CASE("close skin: whatever the body, it ends, is closed, and changes nothing a second time" *
          doctest::test_suite("slow")) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    INFO("seed ", seed);
    LabelVolume body = test::random_body(seed).regions;
    for (Label& label : body.voxels)
      if (label > 4) label = kUpper;
    const LabelVolume around = pad(body, 1);
    for (const SkinGrowth growth : {SkinGrowth::Inward, SkinGrowth::Outward}) {
      const ClosedSkin closed = close_skin(around, table(), growth), again = close_skin(closed.volume, table(), growth);
      CHECK(bare(closed.volume).flesh == 0);
      if (growth == SkinGrowth::Outward) CHECK(bare(closed.volume).bone == 0);
      CHECK(again.changed_voxels == 0);
      close_skin(body, table(), growth);
    }
  }
}
