// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/fem_steps.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/kuhn_mesh.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

FemMesh small_mesh() {
  FemMesh mesh{kuhn_mesh({}, glm::dvec3(0), glm::dvec3(3, 2, 2), {3, 2, 2}), {}, {}};
  for (Eigen::Index t = 0; t < mesh.tets.T.rows(); ++t) {
    mesh.material.push_back({1.0 + double(t), 0.25});
    mesh.joint.push_back(t % 5 == 0);
    mesh.tets.region[t] = static_cast<std::uint16_t>(t % 3);
  }
  return mesh;
}

FemStep small_step(const FemMesh& mesh) {
  FemStep step{0.75, 12, 0.375, {{}, {glm::angleAxis(0.5, glm::dvec3(0, 0, 1)), {1, 2, 3}}}, mesh.tets.V};
  step.V.array() += 0.5;
  return step;
}

}  // namespace

TEST_CASE("steps of finite elements: what is left in files is read as it was, single precision for places") {
  const TemporaryFolder folder;
  const Path name = folder / "solve";
  CHECK_FALSE(read_fem_mesh(name));
  CHECK_FALSE(read_fem_step(name));
  const FemMesh mesh = small_mesh();
  const FemStep step = small_step(mesh);
  write_fem_mesh(mesh, name);
  write_fem_step({.V = mesh.tets.V}, name);
  write_fem_step(step, name);  // replaces the step before
  const auto mesh_back = read_fem_mesh(name);
  const auto step_back = read_fem_step(name);
  REQUIRE(mesh_back);
  REQUIRE(step_back);
  CHECK(mesh_back->tets.V == mesh.tets.V);  // exact, since all coordinates are multiples of a half
  CHECK(mesh_back->tets.T == mesh.tets.T);
  CHECK(mesh_back->tets.region == mesh.tets.region);
  CHECK(mesh_back->joint == mesh.joint);
  for (std::size_t t = 0; t < mesh.material.size(); ++t) {
    CHECK(mesh_back->material[t].shear_modulus == mesh.material[t].shear_modulus);
    CHECK(mesh_back->material[t].poisson_ratio == mesh.material[t].poisson_ratio);
  }
  CHECK(step_back->V == step.V);
  CHECK(step_back->reached == step.reached);
  CHECK(step_back->iteration == step.iteration);
  CHECK(step_back->residual_mm == step.residual_mm);
  REQUIRE(step_back->motions.size() == 2);
  CHECK(step_back->motions[1].rotation == step.motions[1].rotation);
  CHECK(step_back->motions[1].translation == step.motions[1].translation);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);  // no other files are left
}

TEST_CASE("steps of finite elements: files that end early, or tell of nodes that are not there, are refused") {
  const FemMesh mesh = small_mesh();
  const std::string whole = encode(mesh), step = encode(small_step(mesh));
  for (std::size_t size = 0; size < whole.size(); size += 37)
    CHECK_THROWS_AS(decode_fem_mesh(whole.substr(0, size), "here"), Error);
  for (std::size_t size = 0; size < step.size(); size += 7)
    CHECK_THROWS_AS(decode_fem_step(step.substr(0, size), "here"), Error);
  FemMesh wild = mesh;
  wild.tets.T(3, 2) = static_cast<int>(mesh.tets.V.rows());
  CHECK_THROWS_AS(decode_fem_mesh(encode(wild), "here"), Error);
  FemStep nowhere = small_step(mesh);
  nowhere.V(2, 1) = std::nan("");
  CHECK_THROWS_AS(decode_fem_step(encode(nowhere), "here"), Error);
  CHECK_THROWS_AS(decode_fem_mesh(step, "here"), Error);
  CHECK_THROWS_AS(write_fem_step(small_step(mesh), "/no/such/folder/solve"), Error);
}
