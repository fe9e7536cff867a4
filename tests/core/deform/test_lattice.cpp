// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/lattice.h"

#include <doctest/doctest.h>

using namespace limber;

namespace {

// A bar along z on two bones: below `joint` every voxel follows bone 0, above bone 1, and in between both.
struct Bar {
  LabelVolume volume;
  TissueVoxels tissue;
  SkinWeights weights;

  Bar() {
    volume.grid.size = {10, 10, 96};
    volume.grid.spacing = {1.5, 2, 1};
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    for (int z = 1; z < 95; ++z)
      for (int y = 1; y < 9; ++y)
        for (int x = 1; x < 9; ++x) volume.at({x, y, z}) = 1;
    tissue = TissueVoxels(volume);
    weights = SkinWeights({"lower", "upper"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk = weights.chunk(brick);
      auto influence = chunk.begin();
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
        const double upper = glm::clamp((v.z - 40) / 16.0, 0.0, 1.0);
        *influence++ = quantize({{0, 1 - upper}, {1, upper}});
      });
      weights.set_chunk(brick, std::move(chunk));
    }
  }

  std::vector<RigidTransform> bent() const {
    return {{}, rotation_about({8, 10, 48}, glm::angleAxis(0.9, glm::normalize(glm::dvec3(1, 0.3, 0.2))))};
  }
};

}  // namespace

TEST_CASE("lattice: what follows a bone that does not move lies still, what follows another does not") {
  const Bar bar;
  const PosedLattice lattice(bar.volume, bar.tissue, bar.weights, bar.bent(), Blend::Linear, glm::dvec3(1));
  for (std::int64_t b = 0; b < std::ssize(bar.tissue.bricks()); ++b) {
    const int z = bar.tissue.bricks()[b].corner.z;
    INFO("slice ", z);
    CHECK(lattice.is_still(b) == (z < 40));
  }
}

TEST_CASE("lattice: corners of one bone alone lie where its motion carries them, linear or by dual quaternions") {
  const Bar bar;
  const auto motions = bar.bent();
  for (const Blend blend : {Blend::Linear, Blend::DualQuaternion}) {
    const PosedLattice lattice(bar.volume, bar.tissue, bar.weights, motions, blend, glm::dvec3(1));
    PosedLattice::Corners room;
    double furthest = 0;
    for (std::int64_t b = 0; b < std::ssize(bar.tissue.bricks()); ++b) {
      const glm::ivec3 first = bar.tissue.bricks()[b].corner;
      if (first.z < 56) continue;
      const auto& corners = lattice.corners(b, room);
      bar.tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
        if (v.z < 58) return;
        const glm::dvec3 rest = glm::dvec3(v) - 0.5;
        const glm::dvec3 moved = motions[1] * (world_from_voxel(bar.volume.grid) * rest);
        const glm::dvec3 expected = lattice.output().from_rest(voxel_from_world(bar.volume.grid) * moved);
        const glm::ivec3 at = v - first;
        const glm::dvec3 off =
            glm::dvec3(corners[PosedLattice::place(at.x, at.y, at.z)]) / double(kFixedOne) - expected;
        furthest = std::max(furthest, glm::length(off));
      });
    }
    CHECK(furthest < 1.0 / kFixedOne);
  }
}

TEST_CASE("lattice: corners that were forgotten are computed anew, bit for bit") {
  const Bar bar;
  const PosedLattice lattice(bar.volume, bar.tissue, bar.weights, bar.bent(), Blend::DualQuaternion, glm::dvec3(1));
  const auto posed = [&] {
    std::vector<FixedPoint> corners;
    PosedLattice::Corners room;
    for (std::int64_t b = 0; b < std::ssize(bar.tissue.bricks()); ++b) {
      const auto& all = lattice.corners(b, room);
      bar.tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
        const glm::ivec3 at = v - bar.tissue.bricks()[b].corner;
        corners.push_back(all[PosedLattice::place(at.x, at.y, at.z)]);
      });
    }
    return corners;
  };
  const auto kept = posed();
  lattice.forget_corners_below(INT32_MAX);
  CHECK(posed() == kept);
}
