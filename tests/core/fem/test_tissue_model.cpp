// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/tissue_model.h"

#include <map>

#include <doctest/doctest.h>

#include "core/fem/stretch.h"
#include "core/resample/pose_path.h"
#include "tests/support/bent_tube.h"
#include "tests/support/kuhn_mesh.h"

using namespace limber;

namespace {

struct Body {
  test::BentTube tube;
  TissueVoxels tissue;
  LabelSet is_bone = LabelSet(65536, 0);

  explicit Body(const Grid& grid = {}, int length = 44) : tube(test::bent_tube(grid, length)), tissue(tube.volume) {
    is_bone[test::kBone] = 1;
  }

  BonePath path(double degrees) const {
    return [this, degrees](double t) {
      return bone_motions(tube.weights.bones(), tube.rig, part_of_pose(tube.pose(degrees), t));
    };
  }
  DeformingRegion moving(double degrees, const MovingSettings& settings = {}) const {
    return moving_tissue(tube.volume, tissue, tube.weights, path(degrees), settings);
  }
};

std::int64_t count(const TissueMask& mask) {
  std::int64_t voxels = 0;
  for (const auto& brick : mask)
    for (std::uint64_t slice : brick) voxels += std::popcount(slice);
  return voxels;
}

bool has(const TissueMask& mask, const TissueVoxels& tissue, const glm::ivec3& v) {
  return mask[tissue.brick_at(v)][v.z & 7] >> ((v.x & 7) + 8 * (v.y & 7)) & 1;
}

TissueModel model_of(const Body& body, const DeformingRegion& moving, int side) {
  const LabelVolume regions = regions_to_mesh(body.tube.volume, body.tissue, body.is_bone, body.tube.weights, moving);
  return tissue_model(body.tube.volume, body.tissue, body.tube.tissues, body.tube.weights, moving,
                      test::kuhn_mesh_of(regions, side));
}

}  // namespace

TEST_CASE("moving tissue: nothing bends at rest or when the whole body turns") {
  const Body body;
  CHECK(body.moving(0).empty());
  Pose turned = rest_pose(body.tube.rig);
  turned.rotation[0] = glm::angleAxis(1.0, glm::normalize(glm::dvec3(1, 2, 3)));
  turned.root_translation = {5, 6, 7};
  const BonePath path = [&](double t) {
    return bone_motions(body.tube.weights.bones(), body.tube.rig, part_of_pose(turned, t));
  };
  const DeformingRegion moving = moving_tissue(body.tube.volume, body.tissue, body.tube.weights, path);
  CHECK(moving.empty());
  CHECK(moving.moves_as == std::vector<int>{0, 0});
}

TEST_CASE("moving tissue: what bends lies around the joint, in a rim that is held, however long the limb is") {
  std::vector<std::int64_t> free, meshed;
  for (int length : {120, 240}) {
    const Body body({}, length);
    const DeformingRegion moving = body.moving(50, {.margin_mm = 10, .rim_mm = 8});
    CHECK(moving.moves_as == std::vector<int>{0, 1});
    free.push_back(count(moving.free));
    meshed.push_back(count(moving.meshed));
    CHECK(free.back() > 0);
    CHECK(meshed.back() > free.back());
    bool inside = true, near = true, rim = true;
    body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      const bool is_free = has(moving.free, body.tissue, v), is_meshed = has(moving.meshed, body.tissue, v);
      const int off = std::abs(v.z - length / 2);
      // Lengths in voxels of 1 mm: weights blend up to 6 from the joint. The margin of 10 follows, then at most two
      // cells of 4, then the held rim of 8.
      if (off < 8) inside &= is_free;
      if (off > 6 + 10 + 8) near &= !is_free;
      if (off > 6 + 10 + 8 + 8) rim &= !is_meshed;
      if (is_free) rim &= is_meshed;
    });
    CHECK(inside);
    CHECK(near);
    CHECK(rim);

    const SkinWeights rigid = with_rigid_rest(body.tube.weights, body.tissue, moving);
    bool whole = true, kept = true;
    for (std::int64_t b = 0; b < rigid.chunk_count(); ++b) {
      auto now = rigid.chunk(b).begin();
      auto before = body.tube.weights.chunk(b).begin();
      body.tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
        if (has(moving.free, body.tissue, v)) kept &= *now == *before;
        else whole &= (*now).weight[0] == kFullWeight;
        ++now;
        ++before;
      });
    }
    CHECK(whole);
    CHECK(kept);
  }
  CHECK(free[0] == free[1]);
  CHECK(meshed[0] == meshed[1]);
}

TEST_CASE("moving tissue: with contact also what the pose brings together may bend") {
  const Body body({}, 160);
  const MovingSettings without{.margin_mm = 8, .rim_mm = 8, .contact = false, .near_mm = 10};
  MovingSettings with = without;
  with.contact = true;
  const DeformingRegion apart = body.moving(165, without), close = body.moving(165, with), open = body.moving(40, with);
  CHECK(count(close.free) > 1.5 * count(apart.free));
  CHECK(count(open.free) == count(body.moving(40, without).free));
}

TEST_CASE("moving tissue: what meets on the way may bend, though it is apart again wherever the path is tested") {
  const Body body({}, 160);
  const MovingSettings without{.margin_mm = 8, .rim_mm = 8, .contact = false, .near_mm = 10};
  MovingSettings with = without;
  with.contact = true;
  // The tube is bent by 40 degrees at a quarter and at half of the path, and by 165 degrees between.
  const BonePath there_and_back = [&](double t) {
    const double bump = std::max(0.0, 1 - std::abs(t - 0.375) / 0.125);
    return bone_motions(body.tube.weights.bones(), body.tube.rig, body.tube.pose(40 + 125 * bump));
  };
  const auto moving = [&](const MovingSettings& settings) {
    return moving_tissue(body.tube.volume, body.tissue, body.tube.weights, there_and_back, settings);
  };
  CHECK(count(moving(with).free) > 1.5 * count(moving(without).free));
}

TEST_CASE("moving tissue: what the pose brings together later moves as a rigid body before") {
  const Body body({}, 160);
  const MovingSettings settings{.margin_mm = 8, .rim_mm = 8, .contact = true, .near_mm = 10};
  constexpr double kWhole = 165;
  const DeformingRegion whole = body.moving(kWhole, settings);
  std::map<float, std::int64_t> voxels;
  bool same = true;
  body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const float from = whole.free_from_at(body.tissue, v);
    ++voxels[from];
    same &= has(whole.free, body.tissue, v) == (from < INFINITY);
  });
  CHECK(same);
  REQUIRE(voxels.size() > 2);  // some voxels are free from the start, some never, some from later on
  CHECK(voxels.begin()->first == 0);
  for (const auto& [from, count] : voxels) {
    if (from == 0 || from == INFINITY) continue;
    // If the pose ends at the position `from` of the path, voxels that become free only there are not free yet.
    const DeformingRegion part = body.moving(kWhole * from, settings);
    bool still = true;
    body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      still &= whole.free_from_at(body.tissue, v) != from || !has(part.free, body.tissue, v);
    });
    CHECK(still);
  }

  const TissueModel model = model_of(body, whole, 8);
  CHECK(!model.fem.waiting.empty());
  for (const auto& [node, bone, until] : model.fem.waiting) {
    CHECK(model.fem.held_by[node] < 0);
    CHECK(bone == (model.fem.mesh.V(node, 2) < 80 ? 0 : 1));
    CHECK(voxels.count(float(until)) == 1);
  }
}

TEST_CASE(
    "tissue model: bones hold the nodes of their tets, the rim is held, and what lies between two bones is the joint") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    const Body body(grid, 120);
    const DeformingRegion moving = body.moving(50, {.margin_mm = 12, .rim_mm = 10});
    const TissueModel model = model_of(body, moving, 4);
    const TetMesh& mesh = model.fem.mesh;
    REQUIRE(model.fem.held_by.size() == std::size_t(mesh.V.rows()));
    REQUIRE(model.fem.influences.size() == std::size_t(mesh.V.rows()));
    REQUIRE(model.fem.material.size() == std::size_t(mesh.T.rows()));
    int near = 0, far = 0, free = 0, joint = 0;
    bool held = true, sums = true;
    for (int t = 0; t < mesh.T.rows(); ++t) {
      joint += model.joint[t];
      if (mesh.region[t] == TetMesh::kSoft || model.joint[t]) continue;
      for (int i = 0; i < 4; ++i) held &= model.fem.held_by[mesh.T(t, i)] == TetMesh::bone_of(mesh.region[t]);
    }
    const AffineTransform voxel = voxel_from_world(grid);
    for (int i = 0; i < mesh.V.rows(); ++i) {
      double sum = 0;
      for (const BoneWeight& influence : model.fem.influences[i]) sum += influence.weight;
      sums &= std::abs(sum - 1) < 1e-12;
      const int holder = model.fem.held_by[i];
      (holder < 0 ? free : holder == 0 ? near : far) += 1;
      const double z = (voxel * glm::dvec3(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2))).z;
      if (holder >= 0) held &= (holder == 1) == (z > 60);
    }
    CHECK(held);
    CHECK(sums);
    CHECK(near > 0);
    CHECK(far > 0);
    CHECK(free > 0);
    CHECK(joint == 0);  // the bones end four voxels from the joint, which is more than a tet
  }
  // Makes the two bones meet.
  Body body;
  for (int z = 14; z < 30; ++z)
    for (int y = 10; y < 15; ++y)
      for (int x = 9; x < 14; ++x) body.tube.volume.at({x, y, z}) = test::kBone;
  for (std::int64_t b = 0; b < body.tube.weights.chunk_count(); ++b) {
    SkinWeights::Influences chunk = body.tube.weights.chunk(b);
    auto influence = chunk.begin();
    body.tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
      if (body.tube.volume.at(v) == test::kBone) *influence = rigid_influence(v.z >= 22);
      ++influence;
    });
    body.tube.weights.set_chunk(b, std::move(chunk));
  }
  const TissueModel model = model_of(body, body.moving(50), 2);
  int joint = 0;
  for (int t = 0; t < model.fem.mesh.T.rows(); ++t) {
    if (!model.joint[t]) continue;
    ++joint;
    CHECK(model.fem.material[t].shear_modulus == 1);
    CHECK(model.fem.material[t].poisson_ratio == 0.3);
  }
  CHECK(joint > 0);
}

TEST_CASE(
    "tissue model: a tet is as stiff as its tissue in the mean and as full as it is, and a mesh that grows says so for "
    "each label") {
  Body body;
  for (Tissue& tissue : body.tube.tissues.tissues)
    if (tissue.label == test::kFat) {
      tissue.young_modulus = 6;
      tissue.poisson_ratio = 0.5;  // incompressible; the solver uses at most 0.4999
    } else if (tissue.label == test::kSkin) {
      tissue.young_modulus = 30;
      tissue.poisson_ratio = 0.25;
    }
  const TissueModel model = model_of(body, body.moving(50), 4);
  const double fat = 6 / (2 * 1.4999), skin = 30 / 2.5, fat_lambda = lame_lambda(fat, 0.4999),
               skin_lambda = lame_lambda(skin, 0.25);
  int fat_only = 0, mixed = 0, empty = 0;
  double whole = 0;
  for (int t = 0; t < model.fem.mesh.T.rows(); ++t) {
    double fats = 0, skins = 0, bones = 0;
    for (std::int32_t i = model.first[t]; i < model.first[t + 1]; ++i) {
      const auto& [label, mm3] = model.parts[i];
      whole += mm3;
      (label == test::kFat ? fats : label == test::kSkin ? skins : bones) += mm3;
    }
    if (model.fem.mesh.region[t] != TetMesh::kSoft) continue;
    const TetMaterial& material = model.fem.material[t];
    CHECK(material.filled ==
          doctest::Approx(std::max(0.1, (fats + skins) / signed_volume(model.fem.mesh.V, model.fem.mesh.T.row(t)))));
    if (fats + skins == 0) {
      ++empty;
      CHECK((material.shear_modulus == doctest::Approx(fat) || material.shear_modulus == doctest::Approx(skin)));
      continue;
    }
    (skins == 0 ? fat_only : mixed) += 1;
    CHECK(material.shear_modulus == doctest::Approx((fats * fat + skins * skin) / (fats + skins)));
    CHECK(lame_lambda(material.shear_modulus, material.poisson_ratio) ==
          doctest::Approx((fats * fat_lambda + skins * skin_lambda) / (fats + skins)));
  }
  CHECK(fat_only > 0);
  CHECK(mixed > 0);
  CHECK(empty > 0);
  CHECK(whole == doctest::Approx(double(body.tissue.size()) * body.tube.volume.grid.voxel_volume()).epsilon(0.01));

  Eigen::MatrixX3d grown = model.fem.mesh.V;
  for (const auto& [label, percent] : volume_change_percent(model, grown)) CHECK(std::abs(percent) < 1e-10);
  grown.col(2) *= 1.03;
  for (const Label label : {test::kSkin, test::kFat, test::kBone})
    CHECK(volume_change_percent(model, grown).at(label) == doctest::Approx(3));
}

TEST_CASE(
    "tissue model: no soft tissue counts as stiffer than a solid of its width could be, whatever the table says") {
  Body body;
  for (Tissue& tissue : body.tube.tissues.tissues)
    if (tissue.label == test::kFat) tissue.young_modulus = 1.2e6;  // the modulus of a tendon along its fibres
  const TissueModel model = model_of(body, body.moving(50), 4);
  double stiffest = 0;
  for (int t = 0; t < model.fem.mesh.T.rows(); ++t)
    if (model.fem.mesh.region[t] == TetMesh::kSoft) stiffest = std::max(stiffest, model.fem.material[t].shear_modulus);
  CHECK(stiffest == doctest::Approx(TissueModelSettings{}.stiffest));
}

TEST_CASE("stretch: a turn stretches nothing, a pull and a press show as they are, and percentiles count voxels") {
  const Body body;
  const TissueModel model = model_of(body, body.moving(50), 4);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const auto& [label, stretch] : stretches(model, model.fem.mesh.V * turn.transpose()))
    for (int i = 0; i < 3; ++i) {
      CHECK(stretch.least[i] == doctest::Approx(1));
      CHECK(stretch.most[i] == doctest::Approx(1));
    }
  const Eigen::MatrixX3d pulled = model.fem.mesh.V * Eigen::Vector3d(1.5, 0.7, 1).asDiagonal() * turn.transpose();
  const auto seen = stretches(model, pulled);
  REQUIRE(seen.count(test::kSkin) == 1);
  for (const Label label : {test::kSkin, test::kFat}) {
    CHECK(seen.at(label).least[0] == doctest::Approx(0.7));
    CHECK(seen.at(label).most[2] == doctest::Approx(1.5));
  }

  // Doubles the length of a quarter of the body: a quarter of the fat's voxels are stretched, and no more.
  Eigen::MatrixX3d part = model.fem.mesh.V;
  const double low = part.col(2).minCoeff(), high = part.col(2).maxCoeff(), from = high - 0.25 * (high - low);
  for (auto z : part.col(2)) z += std::max(0.0, z - from);
  const Stretch fat = stretches(model, part).at(test::kFat);
  CHECK(fat.most[1] == doctest::Approx(1));
  CHECK(fat.least[1] == doctest::Approx(1));
}

TEST_CASE("tissue model: where a pose brings bones close together they are not held, and the rest of them is") {
  const Body body;
  const DeformingRegion moving = body.moving(50);
  const LabelVolume regions = regions_to_mesh(body.tube.volume, body.tissue, body.is_bone, body.tube.weights, moving);
  const auto held_by = [&](const TissueModelSettings& settings) {
    return tissue_model(body.tube.volume, body.tissue, body.tube.tissues, body.tube.weights, moving,
                        test::kuhn_mesh_of(regions, 2), settings)
        .fem;
  };
  // With joint_mm = 0, no part of a bone counts as near another bone at rest.
  const FemModel apart = held_by({.joint_mm = 0});
  std::vector<int> of_bone[2];
  for (Eigen::Index t = 0; t < apart.mesh.T.rows(); ++t)
    if (apart.mesh.region[t] != TetMesh::kSoft)
      for (const int node : apart.mesh.T.row(t)) of_bone[TetMesh::bone_of(apart.mesh.region[t])].push_back(node);
  for (auto& nodes : of_bone) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    REQUIRE(nodes.size() > 20);
  }
  double gap = INFINITY;
  const auto place = [&](int node) {
    return glm::dvec3(apart.mesh.V(node, 0), apart.mesh.V(node, 1), apart.mesh.V(node, 2));
  };
  for (const int a : of_bone[0])
    for (const int b : of_bone[1]) gap = std::min(gap, glm::distance(place(a), place(b)));
  const double towards = place(of_bone[1][0]).z < place(of_bone[0][0]).z ? 1 : -1;

  for (const double into : {-4.0, 0.0, 3.0}) {  // how deep the second bone enters the first one, mm
    CAPTURE(into);
    RigidTransform motion;
    motion.translation = {0, 0, towards * (gap + into)};
    const double closing = 3;
    const FemModel model = held_by({.joint_mm = 0,
                                    .motions = {{RigidTransform{}, RigidTransform{}}, {RigidTransform{}, motion}},
                                    .closing_mm = closing});
    int freed = 0;
    for (int side = 0; side < 2; ++side) {
      std::size_t of_this = 0;
      for (const int node : of_bone[side]) {
        double nearest = INFINITY;
        for (const int other : of_bone[1 - side])
          nearest = std::min(nearest, glm::distance(place(node) + (side == 1 ? motion.translation : glm::dvec3(0)),
                                                    place(other) + (side == 0 ? motion.translation : glm::dvec3(0))));
        if (apart.held_by[node] < 0) continue;
        const bool is_held = model.held_by[node] >= 0;
        if (nearest >= closing) CHECK(is_held);
        of_this += !is_held;
      }
      CHECK(of_this <= of_bone[side].size() / 2);
      freed += static_cast<int>(of_this);
    }
    CHECK((freed > 0) == (into > -closing));
  }
}
