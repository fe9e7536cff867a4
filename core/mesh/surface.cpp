// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface.h"

#include <algorithm>
#include <cstdint>

namespace limber {

namespace {

// The share of tissue in each cell, with a border of air two cells wide, so that neither the blur nor a cube reads
// beyond the array.
struct Field {
  static constexpr int kBorder = 2;
  glm::ivec3 size;
  std::vector<float> share;

  std::int64_t index(const glm::ivec3& c) const {
    return c.x + std::int64_t{size.x} * (c.y + std::int64_t{size.y} * c.z);
  }
  float at(const glm::ivec3& c) const { return share[index(c)]; }
  bool inside(const glm::ivec3& c) const { return at(c) >= 0.5f; }
};

Field padded(const Occupancy& body) {
  Field field{body.grid.size + 2 * Field::kBorder, {}};
  field.share.assign(std::int64_t{field.size.x} * field.size.y * field.size.z, 0);
  for (int z = 0; z < body.grid.size.z; ++z)
    for (int y = 0; y < body.grid.size.y; ++y) {
      const float* row = &body.share[body.grid.index({0, y, z})];
      std::copy(row, row + body.grid.size.x, &field.share[field.index(glm::ivec3(0, y, z) + Field::kBorder)]);
    }
  return field;
}

void blur(Field& field) {
  const std::int64_t steps[] = {1, field.size.x, std::int64_t{field.size.x} * field.size.y};
  std::vector<float> from;
  for (const std::int64_t step : steps) {
    from = field.share;
    for (std::int64_t i = step; i + step < std::ssize(from); ++i)
      field.share[i] = 0.25f * from[i - step] + 0.5f * from[i] + 0.25f * from[i + step];
  }
}

// Computes the mean of the points where the surface crosses the cube's edges, relative to the cube's lowest corner.
// Returns false if all corners are on one side of the surface.
bool crossing(const Field& field, const glm::ivec3& cube, glm::dvec3& place) {
  float share[8];
  int inside = 0;
  for (int corner = 0; corner < 8; ++corner) {
    share[corner] = field.at(cube + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2));
    inside += share[corner] >= 0.5f;
  }
  if (inside == 0 || inside == 8) return false;
  glm::dvec3 sum(0);
  int count = 0;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      const int other = corner | 1 << axis;
      if (other == corner || (share[corner] >= 0.5f) == (share[other] >= 0.5f)) continue;
      glm::dvec3 point(corner & 1, corner >> 1 & 1, corner >> 2);
      point[axis] = (0.5 - share[corner]) / (double{share[other]} - share[corner]);
      sum += point;
      ++count;
    }
  place = sum / double(count);
  return true;
}

}  // namespace

TriangleMesh surface_of(const Occupancy& body) {
  TriangleMesh mesh;
  Field field = padded(body);
  if (std::all_of(body.share.begin(), body.share.end(), [](float share) { return share == 0 || share == 1; }))
    blur(field);
  const AffineTransform to_world = world_from_voxel(body.grid);
  const bool mirrored = glm::determinant(to_world.linear) < 0;

  // Stores the vertices of two layers of cubes only, since every quad joins vertices of one layer or of two successive
  // layers.
  const std::int64_t layer = std::int64_t{field.size.x} * field.size.y;
  std::vector<int> below(layer, -1), here(layer, -1);
  const auto quad = [&](int a, int b, int c, int d, bool outwards) {
    if (outwards != mirrored) mesh.F.insert(mesh.F.end(), {{a, b, c}, {a, c, d}});
    else mesh.F.insert(mesh.F.end(), {{a, c, b}, {a, d, c}});
  };
  for (int z = 0; z + 1 < field.size.z; ++z) {
    std::swap(below, here);
    for (int y = 0; y + 1 < field.size.y; ++y)
      for (int x = 0; x + 1 < field.size.x; ++x) {
        const glm::ivec3 cube(x, y, z);
        const std::int64_t at = x + std::int64_t{field.size.x} * y;
        glm::dvec3 place;
        if (!crossing(field, cube, place)) continue;
        here[at] = static_cast<int>(mesh.V.size());
        mesh.V.push_back(to_world * (place + glm::dvec3(cube - Field::kBorder)));

        // Adds the quads of the three edges that start at the cube's lowest corner. Each quad joins the vertices of the
        // four cubes around its edge.
        const bool inside = field.inside(cube);
        const std::int64_t row = field.size.x;
        if (inside != field.inside(cube + glm::ivec3(1, 0, 0)))
          quad(below[at - row], below[at], here[at], here[at - row], inside);
        if (inside != field.inside(cube + glm::ivec3(0, 1, 0)))
          quad(below[at - 1], here[at - 1], here[at], below[at], inside);
        if (inside != field.inside(cube + glm::ivec3(0, 0, 1)))
          quad(here[at - row - 1], here[at - row], here[at], here[at - 1], inside);
      }
  }
  return mesh;
}

std::vector<glm::dvec3> vertex_normals(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> normals(mesh.V.size(), glm::dvec3(0));
  for (const glm::ivec3& f : mesh.F) {
    const glm::dvec3 area = glm::cross(mesh.V[f.y] - mesh.V[f.x], mesh.V[f.z] - mesh.V[f.x]);
    for (int corner = 0; corner < 3; ++corner) normals[f[corner]] += area;
  }
  for (glm::dvec3& normal : normals) {
    const double length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::dvec3(0, 0, 1);
  }
  return normals;
}

}  // namespace limber
