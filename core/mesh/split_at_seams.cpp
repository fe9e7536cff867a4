// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/split_at_seams.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <Eigen/Geometry>

#include "core/base/disjoint_sets.h"
#include "core/mesh/crossings.h"
#include "core/mesh/voxels_in_tet.h"

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

std::vector<int> split_at_faces(TetMesh& mesh, const std::vector<std::array<int, 3>>& faces,
                                const std::vector<int>& nodes) {
  std::set<std::array<int, 3>> cut;
  std::vector<std::uint8_t> is_at_cut(mesh.V.rows(), 0);
  for (const int node : nodes) is_at_cut[node] = 1;
  for (const auto& [a, b, c] : faces) {
    cut.insert(sorted_face(a, b, c));
    for (const int node : {a, b, c}) is_at_cut[node] = 1;
  }
  const auto end = std::find(is_at_cut.rbegin(), is_at_cut.rend(), 1).base() - is_at_cut.begin();
  std::vector<std::vector<Corner>> corners(end);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (int i = 0; i < 4; ++i)
      if (is_at_cut[mesh.T(t, i)]) corners[mesh.T(t, i)].push_back({t, i, -1});

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
  return copied;
}

namespace {

// Returns the unit vector that points away from the fronts of all faces as far as possible: the largest of its products
// with the faces' unit normals is least.
Eigen::RowVector3d away_from(const std::vector<Eigen::RowVector3d>& normals) {
  constexpr int kSteps = 60;
  Eigen::RowVector3d way = Eigen::RowVector3d::Zero(), best = way;
  for (const Eigen::RowVector3d& normal : normals) way -= normal;
  double least = 1;
  for (int step = 0; step < kSteps; ++step) {
    way.normalize();
    const auto worst = std::max_element(normals.begin(), normals.end(), [&](const auto& one, const auto& other) {
      return one.dot(way) < other.dot(way);
    });
    if (worst->dot(way) < least) least = worst->dot(way), best = way;
    way -= 0.5 / (1 + step) * *worst;
  }
  return best;
}

// Returns for each node at a split the way into its own side, a unit vector; zero for other nodes.
Eigen::MatrixX3d ways_inwards(const TetMesh& mesh, const std::vector<std::array<int, 3>>& faces,
                              const Eigen::MatrixX4i& before) {
  std::set<std::array<int, 3>> cut;
  for (const auto& [a, b, c] : faces) cut.insert(sorted_face(a, b, c));
  // A node was split if tets around it have different nodes at its place.
  std::vector<char> is_split(mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < before.rows(); ++t)
    for (int i = 0; i < 4; ++i)
      if (mesh.T(t, i) != before(t, i)) is_split[mesh.T(t, i)] = is_split[before(t, i)] = 1;
  std::map<int, std::vector<Eigen::RowVector3d>> normals;
  for (Eigen::Index t = 0; t < before.rows(); ++t)
    for (const auto& [i, j, k] : kTetFaces) {
      if (!cut.contains(sorted_face(before(t, i), before(t, j), before(t, k)))) continue;
      const Eigen::RowVector3d a = mesh.V.row(mesh.T(t, i)), b = mesh.V.row(mesh.T(t, j)) - a,
                               c = mesh.V.row(mesh.T(t, k)) - a;
      for (const int corner : {i, j, k})
        if (is_split[mesh.T(t, corner)]) normals[mesh.T(t, corner)].push_back(b.cross(c).normalized());
    }
  // Where only an edge or a node connected the sides, no face was cut: the node moves into its own tets.
  std::map<int, std::vector<Eigen::RowVector3d>> of_border;
  const Eigen::MatrixX3i border = boundary_of(mesh.T);
  for (const auto& face : border.rowwise()) {
    const Eigen::RowVector3d a = mesh.V.row(face[0]), b = mesh.V.row(face[1]) - a, c = mesh.V.row(face[2]) - a;
    for (const int node : face)
      if (is_split[node] && !normals.contains(node)) of_border[node].push_back(b.cross(c).normalized());
  }
  normals.merge(of_border);
  Eigen::MatrixX3d ways = Eigen::MatrixX3d::Zero(mesh.V.rows(), 3);
  for (const auto& [node, of_node] : normals) ways.row(node) = away_from(of_node);
  return ways;
}

}  // namespace

void open_faces(TetMesh& mesh, const std::vector<std::array<int, 3>>& faces, const Eigen::MatrixX4i& before,
                double mm) {
  constexpr double kLeft = 0.5;  // share of a tet's volume that must be left
  constexpr int kHalvings = 5;
  const Eigen::MatrixX3d rest = mesh.V;
  const Eigen::MatrixX3i border = boundary_of(mesh.T);
  Eigen::MatrixX3d shift = mm * ways_inwards(mesh, faces, before);
  for (int round = 0; round < kHalvings; ++round) {
    mesh.V = rest + shift;
    std::vector<char> too_far(mesh.V.rows(), 0);
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
      if (signed_volume(mesh.V, mesh.T.row(t)) < kLeft * signed_volume(rest, mesh.T.row(t)))
        for (const int node : mesh.T.row(t)) too_far[node] = 1;
    for (const auto& [one, other] : crossing_pairs(mesh.V, border))
      for (int i = 0; i < 3; ++i) too_far[border(one, i)] = too_far[border(other, i)] = 1;
    bool any = false;
    for (Eigen::Index v = 0; v < shift.rows(); ++v)
      if (too_far[v] && shift.row(v).squaredNorm() > 0) shift.row(v) *= 0.5, any = true;
    if (!any) break;
  }
}

namespace {

// Removes the marked tets and returns their number.
std::int64_t remove_tets(TetMesh& mesh, const std::vector<char>& lost) {
  const Eigen::Index all = mesh.T.rows();
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < all; ++t) {
    if (lost[t]) continue;
    mesh.T.row(kept) = mesh.T.row(t).eval();
    mesh.region[kept++] = mesh.region[t];
  }
  mesh.T.conservativeResize(kept, 4);
  mesh.region.resize(kept);
  return all - kept;
}

}  // namespace

std::int64_t remove_crossing(TetMesh& mesh) {
  const Eigen::Index all = mesh.T.rows();
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    const auto neighbours = neighbours_of(mesh.T);
    const Eigen::MatrixX3i border = boundary_of(mesh.T, neighbours);
    const auto crossing = crossing_pairs(mesh.V, border);
    if (crossing.empty()) break;
    std::vector<Eigen::Index> tet_of;  // the tet of each triangle of the border
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
      for (const int next : neighbours[t])
        if (next == -1) tet_of.push_back(t);
    std::vector<char> lost(mesh.T.rows(), 0);
    for (const auto& [one, other] : crossing) {
      const auto a = tet_of[one], b = tet_of[other];
      const bool is_soft_a = is_soft_region(mesh.region[a]), is_soft_b = is_soft_region(mesh.region[b]);
      if (is_soft_a && (!is_soft_b || mesh.region[a] >= mesh.region[b])) lost[a] = 1;
      else if (is_soft_b) lost[b] = 1;
    }
    if (remove_tets(mesh, lost) == 0) break;
  }
  return all - mesh.T.rows();
}

std::int64_t remove_flakes(TetMesh& mesh, const VoxelRegions& voxels) {
  constexpr double kLeastTissue = 0.5;  // share of a part's volume
  DisjointSets parts(mesh.V.rows());
  for (const auto& tet : mesh.T.rowwise())
    for (int i = 1; i < 4; ++i) parts.unite(tet[0], tet[i]);
  std::map<int, std::vector<Eigen::Index>> loose;  // the tets of each part without bone
  std::set<int> with_bone;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    if (!is_soft_region(mesh.region[t])) with_bone.insert(parts.least(mesh.T(t, 0)));
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    if (const int part = parts.least(mesh.T(t, 0)); !with_bone.contains(part)) loose[part].push_back(t);
  std::vector<char> lost(mesh.T.rows(), 0);
  const AffineTransform voxel = voxel_from_world(voxels.grid);
  for (const auto& [part, tets] : loose) {
    std::int64_t tissue = 0;
    double mm3 = 0;
    for (const Eigen::Index t : tets) {
      glm::dvec3 corner[4];
      for (int i = 0; i < 4; ++i) {
        const Eigen::RowVector3d at = mesh.V.row(mesh.T(t, i));
        corner[i] = voxel * glm::dvec3(at.x(), at.y(), at.z());
      }
      for_each_row_in_tet(corner, voxels.grid, 0, voxels.grid.size.z - 1, [&](glm::ivec3 v, const glm::ivec3& last) {
        for (; v.x <= last.x; ++v.x) tissue += voxels.tissue.index_of(v) >= 0;
      });
      mm3 += signed_volume(mesh.V, mesh.T.row(t));
    }

    if (double(tissue) * voxels.grid.voxel_volume() < kLeastTissue * mm3)
      for (const Eigen::Index t : tets) lost[t] = 1;
  }
  return remove_tets(mesh, lost);
}

std::vector<int> split_at_seams(TetMesh& mesh, const SampleLattice& lattice, const SurfaceNet& net) {
  std::vector<std::array<int, 3>> faces;
  std::set<int> at_seam;
  net.for_each_triangle([&](int a, int b, int c, const SurfaceNet::Edge& edge) {
    if (edge.length != 1 || !lattice.is_cut(edge.from, edge.axis)) return;
    faces.push_back({a, b, c});
    at_seam.insert({a, b, c});
  });
  const Eigen::Index old = mesh.V.rows();
  const std::vector<int> copied = split_at_faces(mesh, faces);
  std::vector<int> nodes(at_seam.begin(), at_seam.end());
  for (std::size_t i = 0; i < copied.size(); ++i) nodes.push_back(static_cast<int>(old) + static_cast<int>(i));
  return nodes;
}

}  // namespace limber
