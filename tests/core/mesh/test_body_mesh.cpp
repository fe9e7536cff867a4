// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/body_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/mesh/untangle.h"
#include "core/phantom/phantom.h"
#include "core/prepare/prepare.h"
#include "tests/support/tet_shapes.h"

using namespace limber;

namespace {

// Returns the volume of each label: of its tets, and of its voxels, mm3.
struct Volumes {
  std::map<int, double> tets, voxels;
  Volumes(const TetMesh& mesh, const LabelVolume& volume) {
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) tets[mesh.region[t]] += signed_volume(mesh.V, mesh.T.row(t));
    for (const Label label : volume.voxels)
      if (label != 0) voxels[label] += volume.grid.voxel_volume();
  }
};

double least_volume(const TetMesh& mesh) {
  double least = INFINITY;
  for (const auto& tet : mesh.T.rowwise()) least = std::min(least, signed_volume(mesh.V, tet));
  return least;
}

// Returns the number of parts of the mesh that faces connect.
int parts_of(const TetMesh& mesh) {
  const auto neighbours = neighbours_of(mesh.T);
  std::vector<bool> seen(mesh.T.rows(), false);
  int parts = 0;
  for (int first = 0; first < int(mesh.T.rows()); ++first) {
    if (seen[first]) continue;
    ++parts;
    std::vector<int> open{first};
    seen[first] = true;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const int other : neighbours[t])
        if (other >= 0 && !seen[other]) seen[other] = true, open.push_back(other);
    }
  }
  return parts;
}

// Makes a box of voxels: label 1 below, label 2 above, air around. The voxels are no cubes, and the third axis points
// down, so that the grid mirrors the world.
LabelVolume two_layers() {
  LabelVolume volume{{{12, 10, 14}, {2, 2.5, 3}, {5, -7, 9}, glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count(), 0);
  for (int z = 2; z < 12; ++z)
    for (int y = 2; y < 8; ++y)
      for (int x = 2; x < 10; ++x) volume.at({x, y, z}) = z < 7 ? 1 : 2;
  return volume;
}

}  // namespace

TEST_CASE("body mesh: every tissue of a phantom has the volume of its voxels, and no tet is inside out") {
  const Phantom arm = make_arm_phantom(4);
  const BodyMesh body = mesh_body(arm.volume, TissueVoxels(arm.volume));
  CHECK(least_volume(body.mesh) > 0);
  CHECK(body.largest_volume_error < 1e-3);
  const Volumes volumes(body.mesh, arm.volume);
  CHECK(volumes.tets.size() == volumes.voxels.size());
  for (const auto& [label, mm3] : volumes.voxels) {
    INFO("label ", label);
    CHECK(volumes.tets.at(label) == doctest::Approx(mm3).epsilon(1e-3));
  }
  // Neighbours share their nodes: no face has three tets, and faces of one tet only are on the body's skin.
  const auto neighbours = neighbours_of(body.mesh.T);
  for (const auto& around : neighbours)
    for (const int other : around) CHECK(other != -2);
  for (Eigen::Index t = 0; t < body.mesh.T.rows(); t += 97) {
    const glm::dvec3 voxel =
        voxel_from_world(arm.volume.grid) * glm::dvec3(body.mesh.V(body.mesh.T(t, body.voxel_corner[t]), 0),
                                                       body.mesh.V(body.mesh.T(t, body.voxel_corner[t]), 1),
                                                       body.mesh.V(body.mesh.T(t, body.voxel_corner[t]), 2));
    CHECK(arm.volume.at(glm::ivec3(glm::round(voxel))) == body.mesh.region[t]);
  }
}

TEST_CASE("body mesh: unsmoothed, the surfaces are the faces of the voxels, and smoothing makes their area smaller") {
  const LabelVolume volume = two_layers();
  const TissueVoxels tissue(volume);
  const BodyMesh blocks = mesh_body(volume, tissue, {.relaxations = 0}), smooth = mesh_body(volume, tissue);
  const auto area = [](const TetMesh& mesh) {
    const Eigen::MatrixX3i skin = boundary_of(mesh.T);
    double sum = 0;
    for (const auto& f : skin.rowwise()) {
      const Eigen::RowVector3d a = mesh.V.row(f[0]), b = mesh.V.row(f[1]), c = mesh.V.row(f[2]);
      sum += (b - a).cross(c - a).norm() / 2;
    }
    return sum;
  };
  const glm::dvec3 size(8 * 2.0, 6 * 2.5, 10 * 3.0);
  CHECK(area(blocks.mesh) == doctest::Approx(2 * (size.x * size.y + size.y * size.z + size.z * size.x)).epsilon(1e-9));
  CHECK(area(smooth.mesh) < 0.98 * area(blocks.mesh));
  for (const BodyMesh* body : {&blocks, &smooth}) {
    CHECK(least_volume(body->mesh) > 0);
    const Volumes volumes(body->mesh, volume);
    for (const auto& [label, mm3] : volumes.voxels) CHECK(volumes.tets.at(label) == doctest::Approx(mm3).epsilon(1e-3));
  }
}

TEST_CASE("body mesh: a seam separates two parts, and without it they are one") {
  const LabelVolume volume = two_layers();
  TissueVoxels tissue(volume);
  CHECK(parts_of(mesh_body(volume, tissue).mesh) == 1);
  auto seams = std::make_shared<Seams>(volume.grid.size);
  for (int y = 2; y < 8; ++y)
    for (int x = 2; x < 10; ++x) seams->cut({x, y, 4}, 2);  // inside label 1
  tissue.set_seams(seams);
  const BodyMesh cut = mesh_body(volume, tissue);
  CHECK(parts_of(cut.mesh) == 2);
  CHECK(least_volume(cut.mesh) > 0);
  CHECK_FALSE(cut.at_seam.empty());
  const Volumes volumes(cut.mesh, volume);
  for (const auto& [label, mm3] : volumes.voxels) CHECK(volumes.tets.at(label) == doctest::Approx(mm3).epsilon(1e-3));

  // A seam across a part of the layer leaves one part, whose skin is larger.
  auto half = std::make_shared<Seams>(volume.grid.size);
  for (int y = 2; y < 8; ++y)
    for (int x = 2; x < 6; ++x) half->cut({x, y, 4}, 2);
  tissue.set_seams(half);
  const BodyMesh slit = mesh_body(volume, tissue, {.relaxations = 0});
  CHECK(parts_of(slit.mesh) == 1);
  tissue.set_seams(nullptr);
  CHECK(boundary_of(slit.mesh.T).rows() > boundary_of(mesh_body(volume, tissue, {.relaxations = 0}).mesh.T).rows());
}

TEST_CASE("body mesh: at a larger spacing tissues keep the volumes that they had") {
  const Phantom arm = make_arm_phantom(4);
  std::vector<double> volumes(65536, 0);
  for (const Label label : arm.volume.voxels) volumes[label] += arm.volume.grid.voxel_volume();
  const LabelVolume coarse = balanced_regrid(arm.volume, 7);
  const BodyMesh body = mesh_body(coarse, TissueVoxels(coarse), {.volumes = volumes});
  CHECK(least_volume(body.mesh) > 0);
  CHECK(body.mesh.T.rows() < 0.5 * double(mesh_body(arm.volume, TissueVoxels(arm.volume)).mesh.T.rows()));
  const Volumes found(body.mesh, arm.volume);
  for (const auto& [label, mm3] : found.voxels) {
    INFO("label ", label);
    CHECK(found.tets.at(label) == doctest::Approx(mm3).epsilon(2e-3));
  }
}

TEST_CASE("body mesh: one thread and two make the same mesh, and a volume of air is refused") {
  const LabelVolume volume = two_layers();
  const auto mesh = [&](int threads) {
    const ThreadCount in_use(threads);
    return mesh_body(volume, TissueVoxels(volume)).mesh;
  };
  const TetMesh one = mesh(1), two = mesh(2);
  CHECK(one.V == two.V);
  CHECK(one.T == two.T);
  LabelVolume air = volume;
  std::fill(air.voxels.begin(), air.voxels.end(), Label(0));
  CHECK_THROWS_AS(mesh_body(air, TissueVoxels(air)), Error);
}

TEST_CASE("untangle: tets that were turned inside out are upright again, and nodes far away stay") {
  const TetMesh mesh = kuhn_box(8, 8, 8, {0, 0, 0}, {16, 16, 16});
  std::vector<bool> fixed(mesh.V.rows(), false);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v)
    fixed[v] = (mesh.V.row(v).array() == 0).any() || (mesh.V.row(v).array() == 16).any();
  Eigen::MatrixX3d folded = mesh.V;
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v)
    if (!fixed[v] && (mesh.V.row(v).array() - 6).matrix().norm() < 3) folded.row(v) += Eigen::RowVector3d(3.5, -2, 1);
  const std::size_t before = tets_inside_out(folded, mesh.T).size();
  REQUIRE(before > 10);
  const auto mended = [&](int threads) {
    const ThreadCount in_use(threads);
    Eigen::MatrixX3d V = folded;
    CHECK(untangle(V, mesh.V, mesh.T, fixed) == 0);
    CHECK(tets_inside_out(V, mesh.T).empty());
    return V;
  };
  const Eigen::MatrixX3d one = mended(1);
  CHECK(one == mended(2));
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v)
    if (fixed[v] || (mesh.V.row(v).array() > 13.5).all()) CHECK(one.row(v) == folded.row(v));

  // If all nodes are fixed, the mesh does not change, and untangle() returns the number of inverted tets.
  Eigen::MatrixX3d V = folded;
  CHECK(untangle(V, mesh.V, mesh.T, std::vector<bool>(V.rows(), true)) == std::int64_t(before));
  CHECK(V == folded);
}
