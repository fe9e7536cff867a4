// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the volume correction after blending: cells get their volume back by small, smooth shifts, bones stay, and
// cells that do not bend do not move.
#include "core/deform/settled_flesh.h"

#include <cstring>
#include <random>

#include <doctest/doctest.h>
#include <Eigen/SVD>

#include "core/base/parallel.h"
#include "core/deform/lattice.h"
#include "core/deform/volume_shifts.h"

using namespace limber;

namespace {

constexpr Label kFlesh = 1, kBone = 2;

// A limb along z, 28 voxels across. Its two bones, 8 voxels across, end at the joint.
struct Limb {
  static constexpr int kJoint = 40, kMiddle = 16;
  LabelVolume volume;
  TissueVoxels tissue;
  SkinWeights weights;
  LabelSet is_bone = LabelSet(65536);

  explicit Limb(double spacing = 2) {
    is_bone[kBone] = 1;
    volume.grid.size = {32, 32, 80};
    volume.grid.spacing = glm::dvec3(spacing);
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    for (int z = 0; z < 80; ++z)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const double away = glm::length(glm::dvec2(x, y) + 0.5 - double(kMiddle));
          if (away < 14) volume.at({x, y, z}) = away < 4 && std::abs(z - kJoint) > 1 ? kBone : kFlesh;
        }
    tissue = TissueVoxels(volume);
    weights = SkinWeights({"upper", "lower"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk;
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
        const double lower = glm::clamp((v.z - kJoint + 12) / 24.0, 0.0, 1.0);
        chunk.push_back(volume.at(v) == kBone ? rigid_influence(v.z > kJoint) : quantize({{0, 1 - lower}, {1, lower}}));
      });
      weights.set_chunk(brick, chunk);
    }
  }

  std::vector<RigidTransform> bent(double degrees, const RigidTransform& whole = {}) const {
    const glm::dvec3 joint = glm::dvec3(kMiddle - 0.5, kMiddle - 0.5, kJoint) * volume.grid.spacing;
    return {whole, whole * rotation_about(joint, glm::angleAxis(glm::radians(degrees), glm::dvec3(1, 0, 0)))};
  }
  SettledFlesh settled(const std::vector<RigidTransform>& motions, Blend blend = Blend::Mixed) const {
    return SettledFlesh(volume, tissue, weights, is_bone, motions, blend, no_progress());
  }
};

// Returns the volume of the posed cells in voxels, from their corners: for each cube the mean over the ways to split it
// into tets.
double posed_volume(const Limb& limb, const PosedLattice& lattice) {
  double sum = 0;
  PosedLattice::Corners room;
  for (std::int64_t brick = 0; brick < std::ssize(limb.tissue.bricks()); ++brick) {
    const PosedLattice::Corners& corners = lattice.corners(brick, room);
    limb.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - limb.tissue.bricks()[brick].corner;
      const auto at = [&](int c) {
        return glm::dvec3(corners[PosedLattice::place(v.x + (c & 1), v.y + (c >> 1 & 1), v.z + (c >> 2))]) /
               double(kFixedOne);
      };
      for (int c = 0; c < 8; ++c) {  // at each corner, an eighth of the parallelepiped that its edges span
        const double sign = (c & 1 ? -1 : 1) * (c & 2 ? -1 : 1) * (c & 4 ? -1 : 1);
        sum += sign * glm::dot(at(c ^ 1) - at(c), glm::cross(at(c ^ 2) - at(c), at(c ^ 4) - at(c))) / 8;
      }
    });
  }
  return sum;
}

double volume_error(const Limb& limb, const std::vector<RigidTransform>& motions, Blend blend,
                    const SettledFlesh* settled) {
  const PosedLattice lattice(limb.volume, limb.tissue, limb.weights, motions, blend, glm::dvec3(1), no_progress(),
                             settled);
  return posed_volume(limb, lattice) / double(limb.tissue.size()) - 1;
}

// Counts the voxels that are stretched beyond `limit`, by the singular values of the deformation gradient.
int stretched(const Limb& limb, const PosedLattice& lattice, double limit) {
  int count = 0;
  PosedLattice::Corners room;
  for (std::int64_t brick = 0; brick < std::ssize(limb.tissue.bricks()); ++brick) {
    const PosedLattice::Corners& corners = lattice.corners(brick, room);
    limb.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - limb.tissue.bricks()[brick].corner;
      Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
      for (int c = 0; c < 8; ++c) {
        const glm::dvec3 at =
            glm::dvec3(corners[PosedLattice::place(v.x + (c & 1), v.y + (c >> 1 & 1), v.z + (c >> 2))]) /
            double(kFixedOne);
        F += Eigen::Vector3d(at.x, at.y, at.z) *
             Eigen::RowVector3d(c & 1 ? 0.25 : -0.25, c & 2 ? 0.25 : -0.25, c & 4 ? 0.25 : -0.25);
      }
      count += F.jacobiSvd().singularValues()[0] > limit;
    });
  }
  return count;
}

}  // namespace

TEST_CASE("settled flesh: a limb folded onto itself is not pulled out to lumps") {
  const Limb limb;
  const auto motions = limb.bent(140);
  const auto count = [&](const SettledFlesh* settled, double limit) {
    const PosedLattice lattice(limb.volume, limb.tissue, limb.weights, motions, Blend::Mixed, glm::dvec3(1),
                               no_progress(), settled);
    return stretched(limb, lattice, limit);
  };
  const SettledFlesh settled = limb.settled(motions);
  CHECK(count(nullptr, 3) == 0);
  CHECK(count(&settled, 3) < limb.tissue.size() / 25);
}

TEST_CASE("settled flesh: a thick limb that is folded beyond its room does not swell") {
  const Limb limb;
  for (const double degrees : {110.0, 130.0, 150.0}) {
    const auto motions = limb.bent(degrees);
    const SettledFlesh settled = limb.settled(motions);
    CHECK(std::abs(volume_error(limb, motions, Blend::Mixed, &settled)) < 0.1);
  }
}

TEST_CASE("settled flesh: a bent limb keeps its volume where blending does not" * doctest::test_suite("slow")) {
  const Limb limb;
  for (const Blend blend : {Blend::Linear, Blend::DualQuaternion, Blend::Mixed})
    for (const double degrees : {60.0, 100.0, -100.0}) {
      const auto motions = limb.bent(degrees);
      const SettledFlesh settled = limb.settled(motions, blend);
      INFO("blend ", int(blend), " by ", degrees, " degrees: ", volume_error(limb, motions, blend, nullptr),
           " without");
      CHECK(std::abs(volume_error(limb, motions, blend, &settled)) < (std::abs(degrees) > 90 ? 0.02 : 0.005));
      CHECK(settled.report().volume_error_after < 0.25 * settled.report().volume_error_before);
    }
  CHECK(std::abs(volume_error(limb, limb.bent(100), Blend::Linear, nullptr)) > 0.01);
}

TEST_CASE("settled flesh: bones stay where the pose has them") {
  const Limb limb;
  const SettledFlesh settled = limb.settled(limb.bent(90));
  CHECK(settled.report().largest_shift_mm > 2);
  SettledFlesh::CornerShifts shifts;
  double furthest = 0;
  for (std::int64_t brick = 0; brick < std::ssize(limb.tissue.bricks()); ++brick) {
    if (!settled.corner_shifts(brick, shifts)) continue;
    limb.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - limb.tissue.bricks()[brick].corner;
      const double across = glm::length(glm::dvec2(voxel) + 0.5 - double(Limb::kMiddle));
      if (limb.volume.at(voxel) == kBone && across < 2)
        furthest = std::max<double>(furthest, glm::length(shifts[PosedLattice::place(v.x, v.y, v.z)]));
    });
  }
  CHECK(furthest < 0.1);  // largest shift of a corner of bone, voxels
}

TEST_CASE("settled flesh: a body that moves as one, or not at all, does not settle") {
  const Limb limb;
  const RigidTransform away{glm::angleAxis(1.1, glm::normalize(glm::dvec3(1, 2, -1))), {40, -3, 7}};
  for (const auto& motions : {limb.bent(0), limb.bent(0, away)}) {
    const SettledFlesh settled = limb.settled(motions);
    CHECK(settled.report().cells == 0);
    SettledFlesh::CornerShifts shifts;
    CHECK_FALSE(settled.corner_shifts(0, shifts));
  }
}

TEST_CASE("settled flesh: shifts turn with the body, and grow with it") {
  const Limb limb, large(20);
  const glm::dquat turn = glm::angleAxis(0.8, glm::normalize(glm::dvec3(2, -1, 1)));
  const SettledFlesh still = limb.settled(limb.bent(45)), turned = limb.settled(limb.bent(45, {turn, {100, 20, 3}})),
                     grown = large.settled(large.bent(45));
  SettledFlesh::CornerShifts a, b, c;
  double off = 0, off_grown = 0;
  for (std::int64_t brick = 0; brick < std::ssize(limb.tissue.bricks()); ++brick) {
    if (!still.corner_shifts(brick, a) || !turned.corner_shifts(brick, b) || !grown.corner_shifts(brick, c)) continue;
    for (std::size_t i = 0; i < a.size(); ++i) {
      off = std::max(off, glm::length(turn * glm::dvec3(a[i]) - glm::dvec3(b[i])));
      off_grown = std::max<double>(off_grown, glm::length(a[i] - c[i]));
    }
  }
  CHECK(off < 0.01);
  CHECK(off_grown < 0.01);
}

TEST_CASE("settled flesh: 1, 2 and 4 threads give the same bytes") {
  const Limb limb;
  std::vector<SettledFlesh::CornerShifts> all[3];
  for (int run = 0; run < 3; ++run) {
    const ThreadCount threads(1 << run);
    const SettledFlesh settled = limb.settled(limb.bent(75));
    SettledFlesh::CornerShifts shifts;
    for (std::int64_t brick = 0; brick < std::ssize(limb.tissue.bricks()); ++brick)
      if (settled.corner_shifts(brick, shifts)) all[run].push_back(shifts);
  }
  REQUIRE(!all[0].empty());
  for (int run = 1; run < 3; ++run) {
    REQUIRE(all[run].size() == all[0].size());
    CHECK(std::memcmp(all[run].data(), all[0].data(), all[0].size() * sizeof(SettledFlesh::CornerShifts)) == 0);
  }
}

TEST_CASE("settled flesh: two sides of a seam shift on their own") {
  Limb limb;
  auto seams = std::make_shared<Seams>(limb.volume.grid.size);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) seams->cut({x, y, Limb::kJoint + 3}, 2);
  limb.tissue.set_seams(seams);
  const SettledFlesh settled = limb.settled(limb.bent(60));
  double apart = 0;
  for (int y = 8; y < 24; ++y) {
    const glm::ivec3 lowest(Limb::kMiddle, y, Limb::kJoint + 3);
    apart =
        std::max<double>(apart, glm::length(settled.corner_shift(lowest, 0x0f) - settled.corner_shift(lowest, 0xf0)));
  }
  CHECK(apart > 0.05);
}

TEST_CASE("posed bones: the way out of a bone is the shortest, wherever the pose takes it") {
  const Limb limb;
  const auto motions = limb.bent(70);
  const PosedBones bones(limb.volume, limb.tissue, limb.weights, limb.is_bone, motions);
  // Radius of a bone and position of its axis in x and y, mm.
  const double radius = 4 * 2, middle = (Limb::kMiddle - 0.5) * 2;
  for (const bool lower : {false, true})
    for (const double away : {3.0, 6.0}) {
      const glm::dvec3 rest(middle + away, middle, lower ? 130 : 30);
      const auto way = bones.way_out(motions[lower] * rest);
      REQUIRE(way);
      CHECK(std::abs(glm::length(*way) - (radius - away)) < 1);  // within half a voxel, mm
      CHECK(glm::dot(glm::normalize(*way), motions[lower].rotation * glm::dvec3(1, 0, 0)) > 0.9);
    }
  CHECK_FALSE(bones.way_out(motions[1] * glm::dvec3(middle + 11, middle, 130)));
  CHECK_FALSE(bones.way_out({-500, 0, 0}));
  CHECK_FALSE(
      PosedBones(limb.volume, limb.tissue, limb.weights, LabelSet(65536), motions).way_out({middle, middle, 30}));
}

// Two slabs of 12 voxels with air between, each on its own bone. Both also follow a third bone in part, since cells are
// made only where weights blend.
struct Slabs {
  LabelVolume volume;
  TissueVoxels tissue;
  SkinWeights weights;

  Slabs() {
    volume.grid.size = {32, 32, 64};
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    for (int z = 0; z < 64; ++z)
      for (int y = 2; y < 30; ++y)
        for (int x = 2; x < 30; ++x)
          if ((z >= 8 && z < 20) || (z >= 40 && z < 52)) volume.at({x, y, z}) = kFlesh;
    tissue = TissueVoxels(volume);
    weights = SkinWeights({"low", "high", "still"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk;
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
        chunk.push_back(quantize({{v.z > 30, 0.75}, {2, 0.25}}));
      });
      weights.set_chunk(brick, chunk);
    }
  }
  // Moves the slabs towards each other, each by `each` mm where its weight is 0.75.
  std::vector<RigidTransform> together(double each) const {
    const glm::dquat straight(1, 0, 0, 0);
    return {{straight, {0, 0, each / 0.75}}, {straight, {0, 0, -each / 0.75}}, {}};
  }
};

TEST_CASE("flesh contact: two sides go back by half of what they overlap by, and rest beside each other otherwise") {
  const Slabs slabs;
  const TissueDepth depth(slabs.tissue, glm::dvec3(1));
  // Each slab moves by 20 - `each` mm into the gap of 20 mm: first the slabs overlap by 4 mm, then 4 mm stay open.
  for (const double each : {8.0, 12.0}) {
    const auto motions = slabs.together(20 - each);
    const double overlap = 2 * (20 - each) - 20;
    const BrickMotions bricks(slabs.tissue, slabs.weights, motions);
    const FleshCells cells =
        flesh_cells(slabs.volume, slabs.tissue, slabs.weights, LabelSet(65536), motions, Blend::Linear, bricks);
    FleshContact contact(cells, depth, glm::dvec3(1));
    contact.look(cells.blended);
    int met = 0;
    for (std::int32_t n = 0; n < std::ssize(cells.rest); ++n) {
      const auto way = contact.way_apart(n);
      if (!way) continue;
      ++met;
      if (glm::any(glm::lessThan(glm::dvec2(cells.rest[n]), glm::dvec2(8))) ||
          glm::any(glm::greaterThan(glm::dvec2(cells.rest[n]), glm::dvec2(23))))
        continue;
      CHECK(way->z * (cells.rest[n].z < 30 ? -1 : 1) == doctest::Approx(overlap / 2).epsilon(0.4));
      CHECK(glm::length(glm::dvec2(*way)) < 0.5);
    }
    CHECK((met > 0) == (overlap > 0));
  }
  // After the correction, the slabs press against each other.
  const auto motions = slabs.together(12);
  const SettledFlesh settled(slabs.volume, slabs.tissue, slabs.weights, LabelSet(65536), motions, Blend::Linear,
                             no_progress());
  CHECK(settled.corner_shift({15, 15, 19}, 0x0f).z < -0.7);
  CHECK(settled.corner_shift({15, 15, 39}, 0xf0).z > 0.7);
}

TEST_CASE("volume shifts: the nearest matrix of volume one") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> entry(-0.5, 0.5);
  for (int i = 0; i < 500; ++i) {
    glm::dmat3 F(1);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) F[c][r] += entry(random);
    if (std::abs(glm::determinant(F)) < 0.2) continue;
    const glm::dmat3 P = with_volume(F, 1);
    CHECK(glm::determinant(P) == doctest::Approx(1).epsilon(0.03));
    // The result P must be nearer to F than F scaled uniformly to volume one is.
    if (glm::determinant(F) > 0) {
      const glm::dmat3 scaled = F / std::cbrt(glm::determinant(F));
      const auto square = [](const glm::dmat3& M) {
        return glm::dot(M[0], M[0]) + glm::dot(M[1], M[1]) + glm::dot(M[2], M[2]);
      };
      CHECK(square(P - F) <= square(scaled - F) * 1.05 + 1e-9);
    }
  }
  // This F is inverted; the result must not be.
  const glm::dmat3 flat = with_volume(glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -0.3), 1);
  CHECK(glm::determinant(flat) > 0.5);
}

TEST_CASE("volume shifts: a limited stretch keeps volume and directions") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> size(0.3, 4), angle(-3, 3), part(-1, 1);
  const auto turn = [&] {
    return glm::mat3_cast(glm::angleAxis(angle(random), glm::normalize(glm::dvec3(part(random), part(random), 1.1))));
  };
  int limited = 0;
  for (int i = 0; i < 500; ++i) {
    const glm::dmat3 U = turn(), V = turn();
    const glm::dvec3 stretch(size(random), size(random), size(random));
    const glm::dmat3 F = U * glm::dmat3(stretch.x, 0, 0, 0, stretch.y, 0, 0, 0, stretch.z) * glm::transpose(V);
    const double longest = std::max({stretch.x, stretch.y, stretch.z}), blended = size(random);
    const double most = std::max(2.0, blended), volume = 1;
    const glm::dmat3 P = with_stretch(F, volume, blended * turn());
    if (longest <= most) {
      CHECK(P == F);
      continue;
    }
    ++limited;
    // Along the principal axes of the stretch, only the lengths have changed.
    const glm::dmat3 D = glm::transpose(U) * P * V;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        if (a != b) CHECK(std::abs(D[a][b]) < 1e-6);
    for (int a = 0; a < 3; ++a) CHECK(D[a][a] < most * (1 + 1e-6));
    CHECK(glm::determinant(P) == doctest::Approx(volume).epsilon(1e-6));
  }
  CHECK(limited > 100);
}
