// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_system.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <doctest/doctest.h>
#include <Eigen/Sparse>

#include "core/base/parallel.h"
#include "core/binding/flesh_graph.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
constexpr Label kFat = 3;
constexpr int kBones = 3;

// A random box of muscle and fat with holes of air, grains of three bones and seams. It has thin necks, cells that are
// alone in their block, and blocks of several pieces.
struct RandomBody {
  LabelVolume volume;
  TissueTable tissues;
  TissueVoxels tissue;
  ZeroedVector<std::uint16_t> held_by;
  NearestBone nearest;

  RandomBody(const glm::ivec3& size, const glm::dvec3& spacing, unsigned seed) {
    std::mt19937 random(seed);
    volume.grid.size = size;
    volume.grid.spacing = spacing;
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    for (Label& label : volume.voxels) label = random() % 4 == 0 ? Label{0} : random() % 3 == 0 ? kFat : kMuscle;
    tissues = muscle_and_bone();
    tissues.tissues.push_back(tissues.tissues[0]);
    tissues.tissues.back().label = kFat;
    tissues.tissues.back().kind = TissueKind::Fat;
    tissue = TissueVoxels(volume);
    Seams seams(size);
    held_by.assign(tissue.size(), kSoft);
    nearest.bone.resize(tissue.size());
    nearest.distance.resize(tissue.size());
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      for (int axis = 0; axis < 3; ++axis)
        if (v[axis] + 1 < size[axis] && random() % 8 == 0) seams.cut(v, axis);
      if (random() % 40 == 0) held_by[place] = static_cast<std::uint16_t>(random() % kBones);
      nearest.bone[place] = static_cast<std::uint16_t>(random() % kBones);
      nearest.distance[place] = 3.0f + static_cast<float>(random() % 10);
    });
    tissue.set_seams(std::make_shared<const Seams>(seams));
  }

  std::vector<std::int32_t> all_bricks() const {
    std::vector<std::int32_t> bricks(tissue.bricks().size());
    for (std::size_t b = 0; b < bricks.size(); ++b) bricks[b] = static_cast<std::int32_t>(b);
    return bricks;
  }
};

// Returns the temperature of each tissue voxel when `bone` is at 1, and the other bones and all voxels with z >=
// `cold_from` are at 0. Solves the system that flesh_graph.h describes by a direct method.
std::vector<double> exact_temperatures(const RandomBody& body, int bone, int cold_from = 1 << 20) {
  const glm::dvec3 s = body.volume.grid.spacing;
  const glm::dvec3 face = glm::dvec3(s.y * s.z / s.x, s.x * s.z / s.y, s.x * s.y / s.z);
  const double largest = std::max({face.x, face.y, face.z});
  const auto conductivity_of = [&](Label label) { return label == kFat ? 0.43 : 1.0; };
  const Seams& seams = *body.tissue.seams();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(body.tissue.size());
  body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const int i = static_cast<int>(place);
    if (body.held_by[place] != kSoft || v.z >= cold_from) {
      entries.push_back({i, i, 1});
      return;
    }
    double diagonal = 2 * s.x * s.y * s.z / largest / std::pow(body.nearest.distance[place], 2);
    if (body.nearest.bone[place] == bone) b[i] += diagonal;
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 w = v;
      w[direction / 2] += direction % 2 ? 1 : -1;
      if (body.volume.at_or_air(w) == 0) continue;
      if (seams.is_cut(direction % 2 ? v : w, direction / 2)) continue;
      const std::int64_t other = body.tissue.index_of(w);
      const double here = conductivity_of(body.volume.at(v)), there = conductivity_of(body.volume.at(w));
      const bool held = body.held_by[other] != kSoft;
      const double g = face[direction / 2] / largest * (held ? 2 * here : 2 * here * there / (here + there));
      diagonal += g;
      if (held && body.held_by[other] == bone) b[i] += g;
      if (!held) entries.push_back({i, static_cast<int>(other), -g});
    }
    entries.push_back({i, i, diagonal});
  });
  Eigen::SparseMatrix<double> matrix(body.tissue.size(), body.tissue.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd x = solver.solve(b);
  return {x.data(), x.data() + x.size()};
}

// Returns the temperatures by bone and tissue voxel, as HeatSolver finds them.
//   residual    largest residual of the solution that the solver accepts
//   iterations  out: number of iterations
std::vector<std::vector<float>> solved_temperatures(const RandomBody& body, double residual,
                                                    int* iterations = nullptr) {
  const HeatGraph soft(body.volume, body.tissue, body.tissues, body.held_by, body.nearest);
  const std::vector<std::int32_t> bricks = body.all_bricks();
  HeatSystem system;
  soft.fill(bricks, system);
  HeatVectors vectors;
  HeatSolver solver(system, kBones, vectors);
  soft.add_sources(bricks, system, {0, 1, 2}, solver);
  const MultigridReport report = solver.solve(residual, 200);
  CHECK(report.residual <= residual);
  if (iterations) *iterations = report.iterations;
  std::vector<std::vector<float>> temperatures(kBones, std::vector<float>(body.tissue.size(), 0.0f));
  body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const int slot = HeatSystem::slot_of(v & 7);
    CHECK(system.is_cell(body.tissue.brick_at(v), slot) == (body.held_by[place] == kSoft));
    for (int bone = 0; bone < kBones; ++bone)
      if (body.held_by[place] == kSoft)
        temperatures[bone][place] = solver.temperature(body.tissue.brick_at(v), bone, slot);
  });
  return temperatures;
}
}  // namespace

TEST_CASE("heat system: slots and voxels of a brick are told from each other") {
  for (int slot = 0; slot < HeatSystem::kSlots; ++slot) {
    const glm::ivec3 voxel = HeatSystem::voxel_of(slot);
    CHECK(HeatSystem::slot_of(voxel) == slot);
    CHECK(((voxel.x + voxel.y + voxel.z) & 1) == (slot >= HeatSystem::kColour));
  }
}

TEST_CASE("heat system: temperatures are those of elimination, with holes, seams and long voxels") {
  for (const glm::dvec3& spacing : {glm::dvec3(1), glm::dvec3(1, 1.2, 3), glm::dvec3(4, 1, 1)}) {
    const RandomBody body({21, 19, 26}, spacing, 7);
    const auto solved = solved_temperatures(body, 1e-6);
    for (int bone = 0; bone < kBones; ++bone) {
      const std::vector<double> exact = exact_temperatures(body, bone);
      double worst = 0;
      for (std::int64_t place = 0; place < body.tissue.size(); ++place)
        if (body.held_by[place] == kSoft) worst = std::max(worst, std::abs(exact[place] - solved[bone][place]));
      CHECK(worst < 2e-4);
    }
  }
}

TEST_CASE("heat system: iterations stay few when the body grows and when voxels are flat or long" *
          doctest::test_suite("slow")) {
  for (const auto& [size, spacing] : std::vector<std::pair<glm::ivec3, glm::dvec3>>{{{16, 16, 16}, glm::dvec3(1)},
                                                                                    {{64, 64, 64}, glm::dvec3(1)},
                                                                                    {{40, 40, 40}, {0.5, 3, 20}},
                                                                                    {{60, 60, 20}, {0.28, 0.28, 1}}}) {
    int iterations = 0;
    solved_temperatures(RandomBody(size, spacing, 3), 1e-5, &iterations);
    CHECK(iterations <= 20);
  }
}

TEST_CASE("heat system: 1, 2 and 4 threads give the same bits" * doctest::test_suite("slow")) {
  const RandomBody body({60, 50, 70}, glm::dvec3(1), 9);
  std::vector<std::vector<std::vector<float>>> results;
  for (const int threads : {1, 2, 4}) {
    const ThreadCount limit(threads);
    results.push_back(solved_temperatures(body, 1e-5));
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

TEST_CASE("heat system: bricks that are left out count as cold") {
  // Solves with the lower half of the bricks only. The result must equal exact temperatures with the upper half held at
  // 0.
  const RandomBody body({16, 16, 32}, glm::dvec3(1), 5);
  const HeatGraph soft(body.volume, body.tissue, body.tissues, body.held_by, body.nearest);
  std::vector<std::int32_t> lower;
  for (const std::int32_t b : body.all_bricks())
    if (body.tissue.bricks()[b].corner.z < 16) lower.push_back(b);
  HeatSystem system;
  soft.fill(lower, system);
  HeatVectors vectors;
  HeatSolver solver(system, 1, vectors);
  soft.add_sources(lower, system, {0, -1, -1}, solver);
  solver.solve(1e-6, 100);
  const std::vector<double> exact = exact_temperatures(body, 0, 16);
  double worst = 0;
  body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const auto brick = std::find(lower.begin(), lower.end(), body.tissue.brick_at(v));
    if (brick == lower.end() || body.held_by[place] != kSoft) return;
    worst = std::max(worst,
                     std::abs(exact[place] - solver.temperature(brick - lower.begin(), 0, HeatSystem::slot_of(v & 7))));
  });
  CHECK(worst < 2e-4);
}
