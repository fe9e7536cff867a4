// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests flesh that slides over bone, on limbs built in code.
#include <algorithm>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/resample/fem_shape.h"
#include "core/resample/resample.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

// A tube of skin and fat on two bones, bent at the joint between them.
Posed bent(bool slides, TissueKind around_bone = TissueKind::Fat) {
  test::BentTube tube = test::bent_tube({}, 84);
  for (Tissue& tissue : tube.tissues.tissues)
    if (tissue.label == test::kFat) tissue.kind = around_bone;
  return resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(70),
                  Fem{.contact = true, .spacing_mm = 4, .slides = slides});
}

}  // namespace

TEST_CASE(
    "fem sliding: skin and fat over a bent joint slide over the bones and are stretched less than if they stick") {
  const Posed slid = bent(true), stuck = bent(false);
  for (const Posed* posed : {&slid, &stuck}) {
    REQUIRE(posed->report.solve);
    INFO(posed->report.solve->blocked_by);
    CHECK(posed->report.solve->converged);
    CHECK(posed->report.mesh->inverted == 0);
    CHECK(*posed->report.mesh->self_intersections == 0);
    CHECK(posed->report.new_hole_voxels == 0);
    for (const auto& bone : posed->report.bones) CHECK(bone.rigid_residual_mm < 0.01);
  }
  CHECK(stuck.report.solve->sliding_nodes == 0);
  CHECK(stuck.report.solve->largest_slide_mm == 0);
  CHECK(slid.report.solve->sliding_nodes > 20);
  CHECK(slid.report.solve->largest_slide_mm > 1);
  CHECK(slid.report.solve->largest_slide_gap_mm < 0.25 * 4);
  const auto most = [](const Posed& posed) { return posed.report.mesh->stretch.at(test::kFat).most[2]; };
  MESSAGE("fat, 95 % of the largest stretch: ", most(slid), " sliding, ", most(stuck), " sticking; ",
          slid.report.solve->sliding_nodes, " nodes slide by ", slid.report.solve->largest_slide_mm,
          " mm at most, off by ", slid.report.solve->largest_slide_gap_mm, " mm");
  CHECK(most(slid) < most(stuck));
}

TEST_CASE("fem sliding: the posed bones are the same voxels whether flesh slides or sticks") {
  const Posed slid = bent(true), stuck = bent(false);
  REQUIRE(slid.volume.grid.spacing == stuck.volume.grid.spacing);
  const auto bones_of = [](const Posed& posed) {
    return std::count(posed.volume.voxels.begin(), posed.volume.voxels.end(), test::kBone);
  };
  CHECK(bones_of(slid) == bones_of(stuck));
}

TEST_CASE("fem sliding: muscle grows onto bone, so it sticks, and every node of sliding flesh lies at one of bone") {
  CHECK(bent(true, TissueKind::Muscle).report.solve->sliding_nodes == 0);
  const Posed slid = bent(true);
  const FemModel& model = slid.shape->model.fem;
  REQUIRE_FALSE(model.mesh.copy_of.empty());
  CHECK(std::ssize(model.sliding) == slid.report.solve->sliding_nodes);
  for (const FemModel::Sliding& each : model.sliding) {
    const int at = model.mesh.copy_of[each.node];
    CHECK(at != each.node);
    CHECK(model.mesh.V.row(at) == model.mesh.V.row(each.node));
    CHECK(model.held_by[at] == each.bone);
    CHECK(model.held_by[each.node] == -1);
  }
  for (Eigen::Index t = 0; t < model.mesh.T.rows(); ++t)
    for (const int v : model.mesh.T.row(t))
      CHECK((model.mesh.region[t] == TetMesh::kSoft || model.mesh.copy_of[v] == v));
}

TEST_CASE("fem sliding: the result is the same for 1 and 2 threads, bit for bit") {
  std::vector<Posed> results;
  for (const int threads : {1, 2}) {
    ThreadCount limit(threads);
    results.push_back(bent(true));
  }
  CHECK(results[0].shape->V == results[1].shape->V);
  CHECK(results[0].volume.voxels == results[1].volume.voxels);
}
