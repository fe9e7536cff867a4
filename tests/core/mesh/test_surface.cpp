// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface.h"

#include <map>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {

LabelVolume volume_of(const Grid& grid, const auto& inside) {
  LabelVolume volume{grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) volume.voxels[grid.index({x, y, z})] = inside(glm::ivec3(x, y, z)) ? 1 : 0;
  return volume;
}

TriangleMesh mesh_of(const LabelVolume& volume, double step = 1) {
  return surface_of(occupancy_of(volume, {0, 1}, step));
}

bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> passes;
  for (const glm::ivec3& f : mesh.F)
    for (int i = 0; i < 3; ++i) {
      const int a = f[i], b = f[(i + 1) % 3];
      passes[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  for (const auto& [edge, sum] : passes)
    if (sum != 0) return false;
  return true;
}

double volume_inside(const TriangleMesh& mesh) {
  double sum = 0;
  for (const glm::ivec3& f : mesh.F) sum += glm::dot(mesh.V[f.x], glm::cross(mesh.V[f.y], mesh.V[f.z])) / 6;
  return sum;
}

}  // namespace

TEST_CASE("surface: a ball's is closed, faces outwards, lies on the ball and holds its volume, on any grid") {
  for (const double mirror : {1.0, -1.0})
    for (const double step : {1.0, 2.5}) {
      Grid grid{{50, 40, 60}, {1, 1.25, 0.8}, {-20, 7, 3}, glm::dmat3(1)};
      grid.direction[1] *= mirror;
      const AffineTransform to_world = world_from_voxel(grid);
      const glm::dvec3 centre = to_world * glm::dvec3(24.5, 19.5, 29.5);
      const double radius = 18;
      const TriangleMesh mesh = mesh_of(
          volume_of(grid, [&](const glm::ivec3& v) { return glm::length(to_world * glm::dvec3(v) - centre) < radius; }),
          step);
      CAPTURE(mirror);
      CAPTURE(step);
      CHECK(is_closed(mesh));
      // The blur moves the surface of a ball inwards by h^2 / 2R, and flat triangles add a sixth of that.
      const double h = std::max(step, 1.25);
      CHECK(volume_inside(mesh) == doctest::Approx(4.0 / 3 * std::numbers::pi * radius * radius * radius)
                                       .epsilon(0.005 + 1.75 * h * h / (radius * radius)));
      const auto normals = vertex_normals(mesh);
      double farthest = 0, least = 1;
      for (std::size_t i = 0; i < mesh.V.size(); ++i) {
        farthest = std::max(farthest, std::abs(glm::length(mesh.V[i] - centre) - radius));
        least = std::min(least, glm::dot(normals[i], glm::normalize(mesh.V[i] - centre)));
      }
      CHECK(farthest < 0.7 * h);
      CHECK(least > 0.8);
    }
}

TEST_CASE("surface: whatever the voxels, it is closed, also at the border of the grid, air has none") {
  std::mt19937 random(5);
  for (int round = 0; round < 20; ++round) {
    const unsigned filled = 1 + round % 4;
    CHECK(is_closed(mesh_of(volume_of({{9, 7, 8}}, [&](const glm::ivec3&) { return random() % 5 < filled; }))));
  }
  CHECK(volume_inside(mesh_of(volume_of({{12, 12, 12}}, [](const glm::ivec3&) { return true; }))) ==
        doctest::Approx(12 * 12 * 12).epsilon(0.06));
  CHECK(mesh_of(volume_of({{4, 4, 4}}, [](const glm::ivec3&) { return false; })).F.empty());
}
