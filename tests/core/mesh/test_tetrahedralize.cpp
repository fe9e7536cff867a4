// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/tetrahedralize.h"

#include <csignal>
#include <cstdlib>
#include <map>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/sanitizer.h"

using namespace limber;

namespace {

constexpr auto kAir = RegionSurface::kAir;

// Adds a box of twelve triangles that face outwards to the surface.
//   inside, outside  the regions on the two sides of the triangles
void add_box(RegionSurface& surface, const Eigen::RowVector3d& low, const Eigen::RowVector3d& high,
             std::uint16_t inside, std::uint16_t outside) {
  const Eigen::Index v = surface.V.rows(), f = surface.F.rows();
  surface.V.conservativeResize(v + 8, 3);
  for (int i = 0; i < 8; ++i)
    surface.V.row(v + i) << (i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2];
  surface.F.conservativeResize(f + 12, 3);
  surface.F.bottomRows(12) << 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1,
      4, 5, 7, 4, 7, 6;
  surface.F.bottomRows(12).array() += static_cast<int>(v);
  surface.sides.insert(surface.sides.end(), 12, {outside, inside});
}

RegionSurface box(double size, std::uint16_t inside = TetMesh::kSoft) {
  RegionSurface surface;
  add_box(surface, Eigen::RowVector3d::Zero(), Eigen::RowVector3d::Constant(size), inside, kAir);
  return surface;
}

// Makes a ball from an octahedron whose faces are cut into n^2 triangles each, with all vertices moved to the sphere.
RegionSurface ball(double radius, const Eigen::RowVector3d& centre, int n = 8) {
  RegionSurface surface;
  std::map<std::array<int, 3>, int> number;
  const auto corner = [&](const Eigen::RowVector3i& p) {
    const auto [at, is_new] = number.emplace(std::array{p[0], p[1], p[2]}, static_cast<int>(number.size()));
    if (is_new)
      surface.V.conservativeResize(number.size(), 3),
          surface.V.row(at->second) = centre + radius * p.cast<double>().normalized();
    return at->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const Eigen::RowVector3i x(octant & 1 ? 1 : -1, 0, 0), y(0, octant & 2 ? 1 : -1, 0), z(0, 0, octant & 4 ? 1 : -1);
    const auto triangle = [&](int i, int j, int side) {  // the corner at step i in x and j in y
      const auto at = [&](int a, int b) { return corner(x * a + y * b + z * (n - a - b)); };
      Eigen::RowVector3i f(at(i, j), at(i + side, j), at(i, j + side));
      if (x[0] * y[1] * z[2] < 0) std::swap(f[1], f[2]);
      surface.F.conservativeResize(surface.F.rows() + 1, 3);
      surface.F.bottomRows(1) = f;
    };
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        if (i + j < n) triangle(i, j, 1);
        if (i > 0 && j > 0) triangle(i, j, -1);
      }
  }
  surface.sides.assign(surface.F.rows(), {kAir, TetMesh::kSoft});
  return surface;
}

double volume_inside(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F) {
  double sum = 0;
  for (const auto& f : F.rowwise())
    sum += signed_volume(
        (Eigen::MatrixX3d(4, 3) << Eigen::RowVector3d::Zero(), V.row(f[0]), V.row(f[1]), V.row(f[2])).finished(),
        {0, 1, 2, 3});
  return sum;
}

std::map<int, double> volumes_by_region(const TetMesh& mesh) {
  std::map<int, double> volumes;
  for (int tet = 0; tet < mesh.T.rows(); ++tet) {
    const double volume = signed_volume(mesh.V, mesh.T.row(tet));
    CHECK(volume > 0);
    volumes[mesh.region[tet]] += volume;
  }
  return volumes;
}

}  // namespace

TEST_CASE(
    "tetrahedralize: a box with a bone in it and a pocket of air beside the bone has the three volumes that it has") {
  RegionSurface surface = box(10);
  add_box(surface, {1, 1, 1}, {4, 4, 4}, 3, TetMesh::kSoft);
  add_box(surface, {5, 5, 5}, {8, 7, 9}, kAir, TetMesh::kSoft);
  const Tetrahedralized result = tetrahedralize_inside(surface);
  INFO(result.failure);
  REQUIRE(result.mesh);
  CHECK(result.mesh->V.topRows(24) == surface.V);
  const auto volumes = volumes_by_region(*result.mesh);
  CHECK(volumes.size() == 2);
  CHECK(volumes.at(3) == doctest::Approx(27).epsilon(1e-12));
  CHECK(volumes.at(TetMesh::kSoft) == doctest::Approx(1000 - 27 - 24).epsilon(1e-12));
  // The boundary is that of the input: the box and the pocket.
  CHECK(boundary_of(result.mesh->T).rows() == 24);
  CHECK(volume_inside(result.mesh->V, boundary_of(result.mesh->T)) == doctest::Approx(1000 - 24).epsilon(1e-12));
}

TEST_CASE("tetrahedralize: a ball is filled with good tetrahedra, the same ones each time") {
  const RegionSurface surface = ball(15, {100, -300, 2000});
  const Tetrahedralized result = tetrahedralize_inside(surface);
  INFO(result.failure);
  REQUIRE(result.mesh);
  CHECK(result.mesh->V.rows() > surface.V.rows());
  CHECK(volumes_by_region(*result.mesh).at(TetMesh::kSoft) ==
        doctest::Approx(volume_inside(surface.V, surface.F)).epsilon(1e-9));
  const Tetrahedralized again = tetrahedralize_inside(surface);
  REQUIRE(again.mesh);
  CHECK(again.mesh->V == result.mesh->V);
  CHECK(again.mesh->T == result.mesh->T);
}

TEST_CASE(
    "tetrahedralize: a crash, a hang, an exit, a failure or too much memory in TetGen is an answer with a reason") {
  const RegionSurface surface = box(10);
  const auto why = [&](TetrahedralizeLimits limits) {
    const Tetrahedralized inside = tetrahedralize_inside(surface, limits);
    CHECK_FALSE(inside.mesh);
    return inside.failure;
  };
  CHECK(why({.at_start = [] { ::raise(SIGSEGV); }}) == "the process crashed (signal 11)");
  CHECK(why({.seconds = 0.05, .at_start = [] { std::this_thread::sleep_for(std::chrono::hours(1)); }}) ==
        "the process took too long");
  CHECK(why({.at_start = [] { std::_Exit(7); }}) == "the process failed (exit code 7)");
  CHECK(why({.at_start = [] { std::_Exit(0); }}) == "TetGen ended without a result");
  CHECK(why({.at_start = [] { throw 2; }}) == "the process failed (exit code 1)");
#ifndef LIMBER_ADDRESS_SANITIZER
  // The child takes all memory that its limit allows before TetGen asks for some.
  const auto eat = [] {
    for (std::size_t size = 1 << 20; size > 1000; size /= 2)
      while (std::malloc(size)) {
      }
  };
  CHECK(tetrahedralize_inside(ball(40, {0, 0, 0}, 40), {.memory_bytes = 16 << 20, .at_start = eat}).failure ==
        "TetGen ran out of memory");
#endif
}

TEST_CASE("tetrahedralize: no surface, one that crosses itself, is open or has no numbers is refused with a reason") {
  const auto refused = [](const RegionSurface& surface) {
    const Tetrahedralized inside = tetrahedralize_inside(surface);
    CHECK_FALSE(inside.mesh);
    CHECK(inside.failure != "");
    return inside.failure;
  };
  CHECK(refused(RegionSurface{}) == "the surface is empty");
  RegionSurface crossing = box(10);
  add_box(crossing, {5, 5, 5}, {15, 15, 15}, TetMesh::kSoft, kAir);
  refused(crossing);
  RegionSurface open = box(10);
  open.F.conservativeResize(11, 3);
  open.sides.pop_back();
  refused(open);
  RegionSurface nowhere = box(10);
  nowhere.V(3, 1) = std::nan("");
  CHECK(refused(nowhere) == "the surface has positions that are not finite numbers");
}

TEST_CASE("tetrahedralize: a cancel while TetGen works is heard") {
  struct : Progress {
  } progress;
  progress.cancel();
  CHECK_THROWS_AS(tetrahedralize_inside(
                      box(10), {.at_start = [] { std::this_thread::sleep_for(std::chrono::hours(1)); }}, progress),
                  Cancelled);
}
