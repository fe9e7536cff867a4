// SPDX-License-Identifier: AGPL-3.0-or-later
// Tet meshes of simple shapes, for tests of meshes and of finite elements.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Dense>

#include "core/mesh/tet_mesh.h"

namespace limber {

// Returns a box of nx x ny x nz cubes. Each cube is split into six tets around its main diagonal, all cubes in the same
// way, so that the tets of neighbouring cubes fit together [Kuhn 1960]. Corner (i, j, k) of the cubes is node i + (nx +
// 1) (j + (ny + 1) k).
inline TetMesh kuhn_box(int nx, int ny, int nz, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TetMesh mesh;
  mesh.V.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
  const auto node = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.V.row(node(i, j, k)) =
            low.transpose().array() + (high - low).transpose().array() *
                                          Eigen::Array3d(double(i) / nx, double(j) / ny, double(k) / nz).transpose();
  mesh.T.resize(6 * nx * ny * nz, 4);
  const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  int t = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (const auto& axes : order) {
          std::array<int, 3> at{i, j, k};
          mesh.T(t, 0) = node(at[0], at[1], at[2]);
          for (int a = 0; a < 3; ++a) {
            ++at[axes[a]];
            mesh.T(t, a + 1) = node(at[0], at[1], at[2]);
          }
          const bool odd = axes[0] == (axes[1] + 1) % 3;  // true: this order of axes turns the tet inside out
          if (odd) std::swap(mesh.T(t, 1), mesh.T(t, 2));
          ++t;
        }
  mesh.region.assign(mesh.T.rows(), TetMesh::kSoft);
  return mesh;
}

// Returns a Kuhn box bent into another shape. Nodes that `bend` moves to the same position (as at a ring's seam) become
// one node.
inline TetMesh bent_box(const TetMesh& box, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& bend) {
  std::map<std::array<long, 3>, int> found;
  std::vector<int> node(box.V.rows());
  std::vector<Eigen::Vector3d> places;
  for (Eigen::Index v = 0; v < box.V.rows(); ++v) {
    const Eigen::Vector3d p = bend(box.V.row(v).transpose());
    const auto [at, fresh] = found.try_emplace(
        {std::lround(p[0] * 1e7), std::lround(p[1] * 1e7), std::lround(p[2] * 1e7)}, int(places.size()));
    if (fresh) places.push_back(p);
    node[v] = at->second;
  }
  TetMesh mesh;
  mesh.V.resize(places.size(), 3);
  for (std::size_t v = 0; v < places.size(); ++v) mesh.V.row(v) = places[v].transpose();
  mesh.T = box.T.unaryExpr([&](int v) { return node[v]; });
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    const auto row = [&](int a) { return Eigen::Vector3d(mesh.V.row(mesh.T(t, a))); };
    if ((row(1) - row(0)).dot((row(2) - row(0)).cross(row(3) - row(0))) < 0) std::swap(mesh.T(t, 2), mesh.T(t, 3));
  }
  mesh.region.assign(mesh.T.rows(), TetMesh::kSoft);
  return mesh;
}

inline TetMesh thick_cylinder(double inner, double outer, double height, int radial, int around, int layers) {
  return bent_box(
      kuhn_box(radial, around, layers, {inner, 0, 0}, {outer, 2 * M_PI, height}),
      [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p[0] * std::cos(p[1]), p[0] * std::sin(p[1]), p[2]); });
}

// Returns an eighth of a hollow ball, where x, y and z are positive. It is made of a quarter of each of three cube
// faces, projected onto spheres. Layers are thinner near the inner sphere.
inline TetMesh thick_sphere_eighth(double inner, double outer, int radial, int across) {
  TetMesh all;
  std::map<std::array<long, 3>, int> found;
  std::vector<Eigen::Vector3d> places;
  std::vector<Eigen::RowVector4i> tets;
  const TetMesh box = kuhn_box(radial, across, across, {0, 0, 0}, {1, 1, 1});
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<int> node(box.V.rows());
    for (Eigen::Index v = 0; v < box.V.rows(); ++v) {
      Eigen::Vector3d direction;
      direction[axis] = 1;
      direction[(axis + 1) % 3] = std::tan(M_PI / 4 * box.V(v, 1));
      direction[(axis + 2) % 3] = std::tan(M_PI / 4 * box.V(v, 2));
      const Eigen::Vector3d p = inner * std::pow(outer / inner, box.V(v, 0)) * direction.normalized();
      const auto [at, fresh] = found.try_emplace(
          {std::lround(p[0] * 1e7), std::lround(p[1] * 1e7), std::lround(p[2] * 1e7)}, int(places.size()));
      if (fresh) places.push_back(p);
      node[v] = at->second;
    }
    // The quarters are rotated against each other, so the diagonals of their common faces might not match. Every
    // hexahedron is therefore split by its nodes' numbers: each of its faces by the diagonal at the face's smallest
    // node [Dompierre et al. 1999].
    for (int k = 0; k < across; ++k)
      for (int j = 0; j < across; ++j)
        for (int i = 0; i < radial; ++i) {
          const auto at = [&](int a, int b, int c) {
            return node[(i + a) + (radial + 1) * ((j + b) + (across + 1) * (k + c))];
          };
          const std::array<int, 8> hex{at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0),
                                       at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)};
          // Makes two tets for each of the three faces that do not contain the hexahedron's node of smallest index:
          // they connect this node with the face.
          const int faces_of[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                      {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
          const int apex = int(std::min_element(hex.begin(), hex.end()) - hex.begin());
          for (const auto& quad : faces_of) {
            if (std::find(quad, quad + 4, apex) != quad + 4) continue;
            int low = 0;
            for (int q = 1; q < 4; ++q)
              if (hex[quad[q]] < hex[quad[low]]) low = q;
            const int a = hex[quad[low]], b = hex[quad[(low + 1) % 4]], c = hex[quad[(low + 2) % 4]],
                      d = hex[quad[(low + 3) % 4]];
            tets.push_back({hex[apex], a, b, c});
            tets.push_back({hex[apex], a, c, d});
          }
        }
  }
  all.V.resize(places.size(), 3);
  for (std::size_t v = 0; v < places.size(); ++v) all.V.row(v) = places[v].transpose();
  all.T.resize(tets.size(), 4);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    Eigen::RowVector4i tet = tets[t];
    const auto row = [&](int a) { return places[tet[a]]; };
    if ((row(1) - row(0)).dot((row(2) - row(0)).cross(row(3) - row(0))) < 0) std::swap(tet[2], tet[3]);
    all.T.row(t) = tet;
  }
  all.region.assign(all.T.rows(), TetMesh::kSoft);
  return all;
}

}  // namespace limber
