// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/preview_map.h"

#include <algorithm>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/deform/inverse_map.h"
#include "core/deform/lattice.h"
#include "core/phantom/phantom.h"
#include "tests/support/bent_tube.h"
#include "tests/support/kuhn_mesh.h"

using namespace limber;

namespace {

// A body with its weights, and a preview of it.
struct Sitter {
  std::shared_ptr<const LabelVolume> volume;
  TissueTable tissues;
  Armature rig;
  TissueVoxels tissue;
  SkinWeights weights;

  LivePreview preview(int step = 4) const { return LivePreview(volume, tissues, tissue, weights, step); }
  std::vector<RigidTransform> motions(const Pose& pose) const { return posed_from_rest(rig, pose); }
};

Sitter tube_sitter(const Grid& grid = {}, int length = 60) {
  test::BentTube tube = test::bent_tube(grid, length);
  Sitter sitter{std::make_shared<const LabelVolume>(tube.volume), tube.tissues, tube.rig, TissueVoxels(tube.volume),
                tube.weights};
  return sitter;
}

const Sitter& arm_sitter() {
  static const Sitter arm = [] {
    Phantom phantom = make_arm_phantom(2);
    SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);
    Sitter sitter{std::make_shared<const LabelVolume>(std::move(phantom.volume)),
                  phantom.tissues,
                  phantom.armature,
                  {},
                  std::move(weights)};
    sitter.tissue = TissueVoxels(*sitter.volume);
    return sitter;
  }();
  return arm;
}

Pose flexed(const Sitter& sitter, const char* bone, double degrees) {
  Pose pose = rest_pose(sitter.rig);
  flex(pose, sitter.rig, require_bone(sitter.rig, bone), degrees);
  return pose;
}

Pose tube_pose(const Sitter& sitter, double degrees, double twist_degrees = 0) {
  Pose pose = rest_pose(sitter.rig);
  const double radians = std::numbers::pi / 180;
  pose.rotation[1] =
      glm::angleAxis(degrees * radians, glm::normalize(sitter.volume->grid.direction[0])) *
      glm::angleAxis(twist_degrees * radians, glm::normalize(sitter.rig.bones[1].tail - sitter.rig.bones[1].head));
  return pose;
}

bool same(const PreviewMap& a, const PreviewMap& b) {
  if (!(a.first == b.first && a.size == b.size && a.nodes == b.nodes && a.apart == b.apart && a.cubes == b.cubes))
    return false;
  for (std::size_t i = 0; i < a.cubes.size(); ++i)
    if (a.cubes[i] != PreviewMap::kNothing && !(a.reach[i].low == b.reach[i].low && a.reach[i].high == b.reach[i].high))
      return false;
  return true;
}

}  // namespace

TEST_CASE("preview: at rest every covered node maps to itself, and all tissue is covered") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()})
    for (const int step : {2, 4, 8}) {
      const Sitter tube = tube_sitter(grid);
      LivePreview preview = tube.preview(step);
      const auto map = preview.update(tube.motions(rest_pose(tube.rig)), Blend::DualQuaternion);
      double furthest = 0;
      for (int z = 0; z < map->size.z; ++z)
        for (int y = 0; y < map->size.y; ++y)
          for (int x = 0; x < map->size.x; ++x) {
            const glm::ivec3 node(x, y, z);
            if (!map->covers(node)) continue;
            const glm::dvec3 voxel = (glm::dvec3(map->first + node) + 0.5) * double(step) - 0.5;
            const glm::dvec3 off = glm::abs(map->rest_of_node(node) - voxel) / map->extent;
            furthest = std::max({furthest, off.x, off.y, off.z});
          }
      CHECK(furthest <= 1.0 / 65535);
      std::int64_t missing = 0;
      tube.tissue.for_each([&](std::int64_t, const glm::ivec3& v) { missing += !map->rest_at(glm::dvec3(v)); });
      CHECK(missing == 0);
    }
}

TEST_CASE("preview: when everything moves rigidly the map is that motion backward, in any direction") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    const Sitter tube = tube_sitter(grid);
    LivePreview preview = tube.preview();
    const RigidTransform move{glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -1))), {31, -17, 222}};
    const auto map = preview.update({move, move}, Blend::Linear);
    const AffineTransform to_world = world_from_voxel(grid), to_voxel = voxel_from_world(grid);
    double furthest = 0;
    std::int64_t missing = 0, broken = 0;
    tube.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      const glm::dvec3 posed = to_voxel * (move * (to_world * glm::dvec3(v)));
      const auto rest = map->rest_at(posed);
      missing += !rest;
      if (rest) furthest = std::max(furthest, glm::length(*rest - glm::dvec3(v)));
      broken += map->cubes[map->index(glm::ivec3(glm::floor(map->node_from_voxel(posed))))] >= PreviewMap::kBroken;
    });
    CHECK(missing == 0);
    CHECK(broken <= tube.tissue.size() / 100);
    CHECK(furthest < 0.02);
  }
}

TEST_CASE(
    "preview: posing step by step gives the same map, bit for bit, as posing at once, for any number of threads") {
  const Sitter tube = tube_sitter({}, 200);
  for (const Blend blend : {Blend::Linear, Blend::DualQuaternion}) {
    LivePreview stepwise = tube.preview();
    std::shared_ptr<const PreviewMap> last;
    // Maps that are still in use, each with a copy that was made when the map was new. A map must stay equal to its
    // copy.
    std::vector<std::pair<std::shared_ptr<const PreviewMap>, PreviewMap>> held;
    for (const double degrees : {0.0, 25.0, 24.0, 24.5, 24.6, 24.7, 24.8, 80.0, 81.0, 80.5, 81.0}) {
      last = stepwise.update(tube.motions(tube_pose(tube, degrees, degrees / 2)), blend);
      if (held.size() < 4 && degrees < 24.7) held.emplace_back(last, *last);
      if (degrees == 24.7) held.clear();
      for (const auto& [map, before] : held) CHECK(same(*map, before));
      LivePreview fresh = tube.preview();
      CHECK(same(*last, *fresh.update(tube.motions(tube_pose(tube, degrees, degrees / 2)), blend)));
    }
    const std::int64_t partial = stepwise.cells_rasterized();
    const ThreadCount one(1);
    LivePreview whole = tube.preview();
    const auto at_once = whole.update(tube.motions(tube_pose(tube, 81, 40.5)), blend);
    CHECK(same(*last, *at_once));
    CHECK(partial < whole.cells_rasterized() * 3 / 4);
    CHECK(stepwise.update(tube.motions(tube_pose(tube, 81, 40.5)), blend) == last);
  }
}

TEST_CASE("preview: after a pose that cannot be shown the next one is right again") {
  const Sitter tube = tube_sitter();
  LivePreview preview = tube.preview(), fresh = tube.preview();
  preview.update(tube.motions(rest_pose(tube.rig)), Blend::Linear);
  auto far = tube.motions(rest_pose(tube.rig));
  far[1].translation.x = 1e7;
  CHECK_THROWS_AS(preview.update(far, Blend::Linear), Error);
  far[1].translation.x = 30000;
  far[1].translation.y = far[1].translation.z = 40000;
  CHECK_THROWS_AS(preview.update(far, Blend::Linear), Error);
  const auto motions = tube.motions(tube_pose(tube, 30));
  CHECK(same(*preview.update(motions, Blend::Linear), *fresh.update(motions, Blend::Linear)));
}

TEST_CASE(
    "preview: an arm bent by 60 degrees is mapped as by the dense lattice, away from folds to a tenth of a voxel" *
    doctest::test_suite("slow")) {
  const Sitter& arm = arm_sitter();
  const auto motions = arm.motions(flexed(arm, "Forearm", 60));
  for (const Blend blend : {Blend::Linear, Blend::DualQuaternion}) {
    LivePreview preview = arm.preview();
    const auto map = preview.update(motions, blend);
    const PosedLattice lattice(*arm.volume, arm.tissue, arm.weights, motions, blend, glm::dvec3(1));
    VoxelRange all{glm::ivec3(INT32_MAX), glm::ivec3(INT32_MIN)};
    std::vector<std::int64_t> bricks;
    for (std::int64_t b = 0; b < std::ssize(arm.tissue.bricks()); ++b) {
      bricks.push_back(b);
      all = {glm::min(all.low, lattice.bounds(b).low >> 16), glm::max(all.high, (lattice.bounds(b).high >> 16) + 1)};
    }
    InverseMap dense;
    dense.reset(all);
    const TissueDepth depth(arm.tissue, arm.volume->grid.spacing);
    rasterize_cells(dense, lattice, bricks, std::vector<int>(65536, 0), &depth);

    std::vector<double> errors;
    std::int64_t missing = 0, covered = 0;
    for (int z = all.low.z; z <= all.high.z; ++z)
      for (int y = all.low.y; y <= all.high.y; ++y)
        for (int x = all.low.x; x <= all.high.x; ++x) {
          const std::int64_t at = dense.index({x, y, z});
          if (dense.cell[at] == InverseMap::kNoCell) continue;
          ++covered;
          const auto rest = map->rest_at(glm::dvec3(glm::ivec3(x, y, z) + lattice.output().base));
          missing += !rest;
          if (rest && !(dense.flags[at] & InverseMap::kOverlap))
            errors.push_back(glm::length(*rest - glm::dvec3(dense.rest[at])));
        }
    std::sort(errors.begin(), errors.end());
    const double median = errors[errors.size() / 2];
    const double near =
        double(std::lower_bound(errors.begin(), errors.end(), 0.5) - errors.begin()) / double(errors.size());
    CHECK(median < 0.1);
    // At most 5 % of the voxels have larger errors: those around the elbow, where rigid bone touches flesh that bends.
    CHECK(near > 0.95);
    CHECK(missing < covered / 1000);
  }
}

TEST_CASE(
    "preview: bones stay stiff: nineteen voxels of twenty are read within half a millimetre of where their bone "
    "carries them" *
    doctest::test_suite("slow")) {
  const Sitter& arm = arm_sitter();
  const auto motions = arm.motions(flexed(arm, "Forearm", 60));
  const AffineTransform to_world = world_from_voxel(arm.volume->grid), to_voxel = voxel_from_world(arm.volume->grid);
  LivePreview preview = arm.preview();
  const auto map = preview.update(motions, Blend::DualQuaternion);
  CHECK(!preview.lattice().parts.empty());
  std::int64_t bone = 0, near = 0;
  for (std::int64_t brick = 0; brick < std::ssize(arm.tissue.bricks()); ++brick) {
    auto influence = arm.weights.chunk(brick).begin();
    arm.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      const Influence& follows = *influence++;
      if (!is_bone(arm.tissues.find(arm.volume->at(v))->kind) || follows.weight[0] != kFullWeight) return;
      ++bone;
      const auto rest = map->rest_at(to_voxel * (motions[follows.bone[0]] * (to_world * glm::dvec3(v))));
      near += rest && glm::length(to_world.linear * (*rest - glm::dvec3(v))) < 0.5;
    });
  }
  INFO(near, " of ", bone);
  CHECK(near * 20 > bone * 19);
}

namespace {

// Two bars along z, joined at the bottom, with a gap of air between. Each follows its own bone, like two fingers of a
// hand.
Sitter fork_sitter(int gap) {
  LabelVolume volume{Grid{}, {}};
  const glm::ivec3 size(40, 20, 72);
  volume.grid.size = size;
  volume.voxels.resize(size_t(size.x) * size.y * size.z);
  for (int z = 4; z < 68; ++z)
    for (int y = 4; y < 16; ++y)
      for (int x = 4; x < 28 + gap; ++x)
        if (z < 12 || x < 16 || x >= 16 + gap)
          volume.voxels[x + std::int64_t{size.x} * (y + std::int64_t{size.y} * z)] = 1;
  Sitter sitter{std::make_shared<const LabelVolume>(volume), {}, {}, TissueVoxels(volume), {}};
  sitter.weights = SkinWeights({"A", "B"}, sitter.tissue);
  for (std::int64_t brick = 0; brick < std::ssize(sitter.tissue.bricks()); ++brick) {
    SkinWeights::Influences chunk;
    sitter.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      const double b = v.z < 12   ? 0.5
                       : v.x < 16 ? std::max(0.0, 0.5 - (v.z - 12) / 16.0)
                                  : std::min(1.0, 0.5 + (v.z - 12) / 16.0);
      chunk.push_back(quantize({{0, 1 - b}, {1, b}}));
    });
    sitter.weights.set_chunk(brick, std::move(chunk));
  }
  return sitter;
}

}  // namespace

TEST_CASE("preview: what lies on both sides of a narrow gap moves apart, and nothing is drawn between" *
          doctest::test_suite("slow")) {
  for (const int step : {4, 8})
    for (const int gap : {1, 2, 3, 5}) {
      CAPTURE(step);
      CAPTURE(gap);
      const Sitter fork = fork_sitter(gap);
      const RigidTransform still{glm::dquat(1, 0, 0, 0), {0, 0, 0}},
          turned{glm::angleAxis(0.6, glm::dvec3(0, 1, 0)), {4, 0, 6}};
      const std::vector<RigidTransform> motions{still, turned};
      LivePreview preview = fork.preview(step);
      CHECK(std::any_of(preview.lattice().has_sides.begin(), preview.lattice().has_sides.end(),
                        [](std::uint8_t each) { return each; }));
      const auto map = preview.update(motions, Blend::DualQuaternion);
      const std::vector<SkinTransform> bones = skin_transforms(motions);
      const auto posed = [&](const glm::ivec3& v) {
        const std::int64_t brick = fork.tissue.brick_at(v);
        const Influence& follows =
            fork.weights.chunk(brick)[fork.tissue.index_of(v) - fork.tissue.bricks()[brick].first];
        const std::array<BoneWeight, 2> weights{{{0, follows.of(0)}, {1, follows.of(1)}}};
        return blend_point(Blend::DualQuaternion, bones, weights, glm::dvec3(v));
      };
      // Counts only where each bar follows a single bone.
      std::int64_t bars = 0, near = 0, drawn = 0, astray = 0;
      fork.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
        if (v.z < 30) return;
        const auto rest = map->rest_at(posed(v));
        ++bars;
        near += rest && glm::length(*rest - glm::dvec3(v)) < 1;
      });
      for (int z = 0; z < map->size.z * step; ++z)
        for (int y = 0; y < map->size.y * step; ++y)
          for (int x = 0; x < map->size.x * step; ++x) {
            const glm::dvec3 at = glm::dvec3(map->first * step + glm::ivec3(x, y, z));
            const auto rest = map->rest_at(at);
            if (!rest) continue;
            const glm::ivec3 v(glm::floor(*rest + 0.5));
            if (v.z < 30 || !fork.volume->at_or_air(v)) continue;
            ++drawn;
            astray += glm::length(posed(v) - at) > 2.5;
          }
      INFO(near, " of ", bars, " found, ", astray, " of ", drawn, " astray");
      CHECK(near * 10 > bars * 9);
      CHECK(astray * 50 < drawn);
    }
}

TEST_CASE("preview: tissue goes where a tet mesh carries it, and what the bones alone say comes back after it") {
  const Sitter tube = tube_sitter(test::oblique_grid());
  const auto rest_motions = tube.motions(rest_pose(tube.rig));
  LivePreview preview = tube.preview();
  const glm::dvec3 size(tube.volume->grid.size);
  const auto mesh =
      std::make_shared<const TetMesh>(test::kuhn_mesh(tube.volume->grid, glm::dvec3(-4), size + 4.0, {10, 10, 20}));
  const auto still = std::make_shared<const Eigen::MatrixX3d>(mesh->V);
  const auto plain = preview.update(rest_motions, Blend::Linear);
  const PreviewMap before = *plain;
  CHECK(same(*preview.update(rest_motions, Blend::Linear, {mesh, still}), before));

  // Swings everything sideways in a wave along z, which no bone motion can do.
  const glm::dvec3 across = tube.volume->grid.direction[0];
  const AffineTransform world = world_from_voxel(tube.volume->grid), voxel = voxel_from_world(tube.volume->grid);
  const auto swung = [&](const glm::dvec3& p) {
    return p + 6 * tube.volume->grid.spacing.x * std::sin(0.08 * (voxel * p).z) * across;
  };
  Eigen::MatrixX3d V = mesh->V;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    const glm::dvec3 p = swung({V(v, 0), V(v, 1), V(v, 2)});
    V.row(v) << p.x, p.y, p.z;
  }
  const auto map = preview.update(rest_motions, Blend::Linear, {mesh, std::make_shared<const Eigen::MatrixX3d>(V)});
  double worst = 0;
  tube.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const glm::dvec3 rest(v);
    if (tube.volume->at(v) == test::kBone) return;  // bone follows its own rig bone, not the mesh
    const auto back = map->rest_at(voxel * swung(world * rest));
    worst = std::max(worst, back ? glm::distance(*back, rest) : 1e9);
  });
  CHECK(worst < 0.5);  // voxels; the nodes are 4 voxels apart
  CHECK(same(*preview.update(rest_motions, Blend::Linear), before));
}
