// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/lattice_net.h"

#include <map>
#include <numbers>
#include <random>

#include <doctest/doctest.h>
#include <Eigen/Geometry>

#include "core/base/parallel.h"
#include "core/mesh/crossings.h"
#include "core/mesh/mesh_quality.h"
#include "tests/support/random_bodies.h"

using namespace limber;

namespace {

struct Body {
  LabelVolume regions;
  TissueVoxels tissue;
  std::vector<std::uint16_t> region;

  explicit Body(LabelVolume volume) : regions(std::move(volume)), tissue(regions), region(tissue.size()) {
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { region[place] = regions.at(v) - 1; });
  }
  VoxelRegions voxels() const { return {regions.grid, tissue, region}; }
};

Body body_of(const Grid& grid, const auto& region_at) {
  LabelVolume volume{grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  const AffineTransform to_world = world_from_voxel(grid);
  glm::ivec3 v;
  for (v.z = 0; v.z < grid.size.z; ++v.z)
    for (v.y = 0; v.y < grid.size.y; ++v.y)
      for (v.x = 0; v.x < grid.size.x; ++v.x) volume.at(v) = Label(region_at(to_world * glm::dvec3(v)));
  return Body(std::move(volume));
}

// A limb along x of two bones that meet at x = 0.
Body limb(const glm::dmat3& direction = glm::dmat3(1)) {
  Grid grid{{80, 36, 36}, {2, 2, 2}, {}, direction};
  grid.origin = -(direction * glm::dvec3(79, 35, 35));
  return body_of(grid, [](const glm::dvec3& p) {
    const double from_axis = std::hypot(p.y - 0.9, p.z + 0.4);
    if (std::abs(p.x) > 70 || from_axis > 30) return 0;
    return from_axis < 10 && std::abs(p.x) > 1 && std::abs(p.x) < 60 ? (p.x < 0 ? 2 : 3) : 1;
  });
}

// Returns true if, around each region, every edge occurs as often in one direction as in the other.
bool regions_are_closed(const RegionSurface& surface) {
  std::map<std::array<int, 3>, int> passes;  // (region, edge) -> occurrences forwards less backwards
  for (Eigen::Index i = 0; i < surface.F.rows(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.F(i, k), b = surface.F(i, (k + 1) % 3), way = a < b ? 1 : -1;
      passes[{surface.sides[i][1], std::min(a, b), std::max(a, b)}] += way;
      passes[{surface.sides[i][0], std::min(a, b), std::max(a, b)}] -= way;
    }
  return std::all_of(passes.begin(), passes.end(), [](const auto& pass) { return pass.second == 0; });
}

// Checks that each node lies in its box, and that the edges of all boxes are shorter than 0.81 of the cell spacing.
void check_boxes(const LatticeNet& net) {
  const glm::dmat3 back = glm::inverse(net.world_from_lattice.linear);
  double outside = 0, largest = 0;
  for (Eigen::Index i = 0; i < net.low.rows(); ++i) {
    const auto row = net.surface.V.row(i);
    const glm::dvec3 place = back * (glm::dvec3(row[0], row[1], row[2]) - net.world_from_lattice.offset);
    for (int k = 0; k < 3; ++k) {
      outside = std::max({outside, net.low(i, k) - place[k], place[k] - net.high(i, k)});
      largest = std::max(largest, net.high(i, k) - net.low(i, k));
    }
  }
  CHECK(outside < 1e-9);
  CHECK(largest < 0.81 * net.spacing_mm);
}

}  // namespace

TEST_CASE("lattice net: a limb of two bones is closed around each region, and encloses its volume, on any grid") {
  glm::dmat3 mirrored(1);
  mirrored[1] *= -1.0;
  const glm::dmat3 turned(glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, 3))));
  for (const glm::dmat3& direction : {glm::dmat3(1), mirrored, turned}) {
    const Body body = limb(direction);
    const LatticeNet net = lattice_net(body.voxels());
    CHECK(regions_are_closed(net.surface));
    check_boxes(net);
    CHECK(net.near >= 0.9995);
    const auto volumes = enclosed_volumes(net.surface, net.surface.V);
    REQUIRE(volumes.size() == 3);
    double whole = 0;
    for (const auto& [region, volume] : volumes) whole += volume;
    const double voxels = double(body.tissue.size()) * 8;
    CHECK(whole == doctest::Approx(voxels).epsilon(0.02));  // 2 % is a layer of 0.15 mm on a limb 30 mm thick
    const double bone = std::count(body.region.begin(), body.region.end(), 1) * 8.0;
    CHECK(volumes.at(1) == doctest::Approx(bone).epsilon(0.25));
    CHECK(volumes.at(2) == doctest::Approx(volumes.at(1)).epsilon(0.2));
  }
}

TEST_CASE("lattice net: no node belongs to two bones, however close they are") {
  const Body body = limb();
  for (const double spacing : {4.0, 8.0, 12.0}) {
    const LatticeNet net = lattice_net(body.voxels(), {.spacing_mm = spacing});
    std::vector<int> bone(net.surface.V.rows(), 0);
    int shared = 0;
    for (Eigen::Index i = 0; i < net.surface.F.rows(); ++i)
      for (const std::uint16_t side : net.surface.sides[i]) {
        if (side == TetMesh::kSoft || side == RegionSurface::kAir) continue;
        for (const int corner : net.surface.F.row(i)) {
          shared += bone[corner] != 0 && bone[corner] != side;
          bone[corner] = side;
        }
      }
    CHECK(shared == 0);
    CHECK(std::count(bone.begin(), bone.end(), 1) > 0);
    CHECK(std::count(bone.begin(), bone.end(), 2) > 0);
  }
}

TEST_CASE("lattice net: around joints it is finer, without a crack, and TetGen fills it") {
  const Body body = limb();
  const LatticeNet coarse = lattice_net(body.voxels());
  const LatticeNet net = lattice_net(body.voxels(), {.fine_around = {{0, 0, 0}}, .fine_radius_mm = 30});
  CHECK(regions_are_closed(net.surface));
  check_boxes(net);
  CHECK(net.surface.F.rows() > 1.5 * coarse.surface.F.rows());
  // Edges near the joint are half as long as far from it.
  double near = 0, far = 0;
  int nears = 0, fars = 0;
  for (const auto& f : net.surface.F.rowwise()) {
    const double length = (net.surface.V.row(f[1]) - net.surface.V.row(f[2])).norm(),
                 x = std::abs(net.surface.V(f[0], 0));
    if (x < 15) near += length, ++nears;
    if (x > 50) far += length, ++fars;
  }
  CHECK(near / nears < 0.6 * far / fars);
  const Tetrahedralized filled = tetrahedralize_inside(net.surface);
  INFO(filled.failure);
  REQUIRE(filled.mesh);
  CHECK(find_fault(*filled.mesh, enclosed_volumes(net.surface, net.surface.V)) == "");
}

TEST_CASE("lattice net: what it says it covers is what its tets cover, and TetGen's") {
  for (const bool fine : {false, true}) {
    LatticeNetSettings settings{.spacing_mm = 9.7};
    if (fine) settings.fine_around = {{0, 0, 0}};
    const Body body = limb();
    const LatticeNet net = lattice_net(body.voxels(), settings);
    const Tetrahedralized filled = tetrahedralize_inside(net.surface);
    REQUIRE(filled.mesh);
    CAPTURE(fine);
    CHECK(net.covered < 1);
    CHECK(net.near > net.covered);
    for (const TetMesh* mesh : {&net.mesh, &*filled.mesh}) {
      const MeshQuality quality = quality_of(*mesh, body.voxels().grid, body.voxels().tissue);
      CHECK(quality.covered == doctest::Approx(net.covered).epsilon(1e-9));
      CHECK(quality.near == doctest::Approx(net.near).epsilon(1e-9));
    }
  }
}

TEST_CASE("lattice net: random bodies are enclosed by a closed surface and filled with positive tets, fine or not") {
  for (unsigned seed = 0; seed < 120; ++seed) {
    const test::RandomBody random = test::random_body(seed);
    const Body body(random.regions);
    CAPTURE(seed);
    CAPTURE(random.kind);
    LatticeNetSettings settings{.spacing_mm = 3.0 + seed % 7};
    if (seed % 3 == 0)
      settings.fine_around = {world_from_voxel(body.regions.grid) * (glm::dvec3(body.regions.grid.size) * 0.5)},
      settings.fine_radius_mm = 12;
    const LatticeNet net = lattice_net(body.voxels(), settings);
    if (body.tissue.size() == 0) {
      CHECK(net.surface.F.rows() == 0);
      CHECK(net.mesh.T.rows() == 0);
      continue;
    }
    CHECK(net.near >= 0.9995);
    CHECK(net.surface.V.allFinite());
    CHECK(regions_are_closed(net.surface));
    check_boxes(net);
    const auto volumes = enclosed_volumes(net.surface, net.surface.V);
    for (const auto& [region, volume] : volumes) CHECK(volume > 0);
    CHECK(find_fault(net.mesh, volumes) == "");
    CHECK(net.mesh.V.topRows(net.surface.V.rows()) == net.surface.V);
  }
}

// Improving the tets moves the surface's nodes within their boxes. The test moves each node to a corner of its box, or
// to a random point in it.
TEST_CASE("lattice net: its tets stay positive and its skin uncrossed wherever the nodes lie in their boxes") {
  std::mt19937 random(5);
  for (const bool fine : {false, true}) {
    LatticeNetSettings settings;
    if (fine) settings.fine_around = {{0, 0, 0}}, settings.fine_radius_mm = 20;
    LatticeNet net = lattice_net(limb().voxels(), settings);
    const AffineTransform& to_world = net.world_from_lattice;
    for (int round = 0; round < 6; ++round) {
      for (Eigen::Index i = 0; i < net.low.rows(); ++i) {
        glm::dvec3 place;
        for (int k = 0; k < 3; ++k) {
          const double share = round % 2 == 0 ? double(random() % 2) : double(random() % 1000) / 999;
          place[k] = net.low(i, k) + share * (net.high(i, k) - net.low(i, k));
        }
        const glm::dvec3 world = to_world * place;
        net.surface.V.row(i) << world.x, world.y, world.z;
      }
      net.mesh.V.topRows(net.surface.V.rows()) = net.surface.V;
      CHECK(find_fault(net.mesh, enclosed_volumes(net.surface, net.surface.V)) == "");
      CHECK(crossing_pairs(net.mesh.V, boundary_of(net.mesh.T)).empty());
    }
  }
}

TEST_CASE("lattice net: far from the surface its tets are those of the body-centred cubic lattice") {
  const LatticeNet net = lattice_net(limb().voxels());  // the limb is too thin for larger tets
  int inner = 0;
  for (const auto& tet : net.mesh.T.rowwise()) {
    if (tet.minCoeff() < net.surface.V.rows()) continue;
    ++inner;
    CHECK(signed_volume(net.mesh.V, tet) == doctest::Approx(std::pow(net.spacing_mm, 3) / 12));
    CHECK(smallest_dihedral(net.mesh.V, tet) == doctest::Approx(std::numbers::pi / 3));
  }
  CHECK(inner > 100);
}

TEST_CASE("lattice net: deep inside a body its tets are larger, step by step, also where a joint makes them small") {
  const Body ball = body_of({{60, 60, 60}, {2, 2, 2}, {-59, -59, -59}, glm::dmat3(1)},
                            [](const glm::dvec3& p) { return glm::length(p) < 58 ? 1 : 0; });
  for (const bool fine : {false, true}) {
    CAPTURE(fine);
    LatticeNetSettings settings{.spacing_mm = 5};
    if (fine) settings.fine_around = {{40, 0, 0}}, settings.fine_radius_mm = 15;
    const LatticeNet net = lattice_net(ball.voxels(), settings);
    CHECK(find_fault(net.mesh, enclosed_volumes(net.surface, net.surface.V)) == "");
    const double usual = std::pow(5.0, 3) / 12;
    double smallest = 1e300, largest = 0, angle = 1e300;
    for (const auto& tet : net.mesh.T.rowwise()) {
      if (tet.minCoeff() < net.surface.V.rows()) continue;
      smallest = std::min(smallest, signed_volume(net.mesh.V, tet));
      largest = std::max(largest, signed_volume(net.mesh.V, tet));
      angle = std::min(angle, smallest_dihedral(net.mesh.V, tet));
    }
    CHECK(largest == doctest::Approx(64 * usual));
    CHECK(smallest < (fine ? 0.2 : 1.01) * usual);
    CHECK(angle > 30 * std::numbers::pi / 180);
    if (!fine) CHECK(double(net.mesh.T.rows()) < 0.7 * ball.tissue.size() * 8 / usual);
  }
}

TEST_CASE("lattice net: the same for one thread and for two") {
  const Body body = limb();
  const LatticeNetSettings settings{.fine_around = {{0, 0, 0}}};
  std::vector<LatticeNet> nets;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    nets.push_back(lattice_net(body.voxels(), settings));
  }
  CHECK(nets[0].surface.V == nets[1].surface.V);
  CHECK(nets[0].surface.F == nets[1].surface.F);
  CHECK(nets[0].surface.sides == nets[1].surface.sides);
  CHECK(nets[0].mesh.V == nets[1].mesh.V);
  CHECK(nets[0].mesh.T == nets[1].mesh.T);
}
