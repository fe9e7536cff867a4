// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/split_at_seams.h"

#include <algorithm>
#include <array>
#include <set>

namespace limber {

namespace {

std::array<int, 3> sorted_face(int a, int b, int c) {
  std::array<int, 3> face{a, b, c};
  std::sort(face.begin(), face.end());
  return face;
}

// A tet that has the node, and the group to which it belongs.
struct Corner {
  Eigen::Index tet;
  int corner, group;
};

}  // namespace

std::vector<int> split_at_seams(TetMesh& mesh, const SampleLattice& lattice, const SurfaceNet& net) {
  std::set<std::array<int, 3>> cut;
  std::vector<std::uint8_t> is_at_seam(mesh.V.rows(), 0);
  net.for_each_triangle([&](int a, int b, int c, const SurfaceNet::Edge& edge) {
    if (edge.length != 1 || !lattice.is_cut(edge.from, edge.axis)) return;
    cut.insert(sorted_face(a, b, c));
    for (const int node : {a, b, c}) is_at_seam[node] = 1;
  });
  std::vector<std::vector<Corner>> corners(net.nodes().size());
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (int i = 0; i < 4; ++i)
      if (is_at_seam[mesh.T(t, i)]) corners[mesh.T(t, i)].push_back({t, i, -1});

  const Eigen::MatrixX4i before = mesh.T;
  std::vector<int> copied;  // the node of which each new node is a copy
  for (std::size_t node = 0; node < corners.size(); ++node) {
    std::vector<Corner>& around = corners[node];
    // Two tets at the node that share a face have its two other corners in common.
    const auto share_open_face = [&](const Corner& a, const Corner& b) {
      std::array<int, 3> shared{static_cast<int>(node), -1, -1};
      int count = 1;
      for (int i = 0; i < 4; ++i)
        if (i != a.corner)
          for (int k = 0; k < 4; ++k)
            if (k != b.corner && before(a.tet, i) == before(b.tet, k) && count < 3) shared[count++] = before(a.tet, i);
      return count == 3 && !cut.contains(sorted_face(shared[0], shared[1], shared[2]));
    };
    int groups = 0;
    for (std::size_t first = 0; first < around.size(); ++first) {
      if (around[first].group >= 0) continue;
      around[first].group = groups;
      std::vector<std::size_t> open{first};
      while (!open.empty()) {
        const Corner from = around[open.back()];
        open.pop_back();
        for (std::size_t k = 0; k < around.size(); ++k)
          if (around[k].group < 0 && share_open_face(from, around[k])) around[k].group = groups, open.push_back(k);
      }
      ++groups;
    }
    const int first_copy = static_cast<int>(mesh.V.rows() + std::ssize(copied)) - 1;
    for (int group = 1; group < groups; ++group) copied.push_back(static_cast<int>(node));
    for (const Corner& corner : around)
      if (corner.group > 0) mesh.T(corner.tet, corner.corner) = first_copy + corner.group;
  }
  const Eigen::Index old = mesh.V.rows();
  mesh.V.conservativeResize(old + std::ssize(copied), 3);
  for (std::size_t i = 0; i < copied.size(); ++i) mesh.V.row(old + i) = mesh.V.row(copied[i]);
  std::vector<int> nodes;
  for (std::size_t node = 0; node < corners.size(); ++node)
    if (!corners[node].empty()) nodes.push_back(static_cast<int>(node));
  for (std::size_t i = 0; i < copied.size(); ++i) nodes.push_back(static_cast<int>(old + i));
  return nodes;
}

}  // namespace limber
