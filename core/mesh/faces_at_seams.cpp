// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/faces_at_seams.h"

#include <algorithm>
#include <map>
#include <utility>

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;

using Pair = std::pair<std::uint16_t, std::uint16_t>;  // two sides, the smaller one first

Pair pair_of(std::uint16_t a, std::uint16_t b) { return {std::min(a, b), std::max(a, b)}; }

// Counts, around each sample, the voxel faces between tissue of two sides and those of them that lie on a seam.
class Contacts {
 public:
  Contacts(const VoxelRegions& voxels, const SampleLattice& lattice) : lattice_(lattice) {
    const Seams* seams = voxels.tissue.seams();
    voxels.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 next = v;
        if (++next[axis] >= voxels.grid.size[axis]) continue;
        const std::int64_t there = voxels.tissue.index_of(next);
        if (there < 0) continue;
        const std::uint16_t a = voxels.side_of(voxels.region[place]), b = voxels.side_of(voxels.region[there]);
        if (a == b) continue;
        Count& count = counts_[{sample_near(lattice.fine_from_voxel * (0.5 * glm::dvec3(v + next))), pair_of(a, b)}];
        ++count.faces;
        count.cut += seams && seams->is_cut(v, axis);
      }
    });
  }

  // Returns true if a seam, or air, separates the two sides at a lattice edge.
  bool is_apart(const SurfaceNet::Edge& edge, const Pair& sides) const {
    glm::ivec3 to = edge.from;
    to[edge.axis] += edge.length;
    const std::int64_t ends[2] = {sample_near(edge.from), sample_near(to)};
    Count sum;
    for (int k = 0; k < (ends[0] == ends[1] ? 1 : 2); ++k)
      if (const auto at = counts_.find({ends[k], sides}); at != counts_.end())
        sum.faces += at->second.faces, sum.cut += at->second.cut;
    return 2 * sum.cut >= sum.faces;
  }

 private:
  struct Count {
    std::int64_t faces = 0, cut = 0;
  };
  // Returns the index of the sample nearest to a place, in the lattice of the usual cells.
  std::int64_t sample_near(const glm::dvec3& place) const {
    const double usual = lattice_.usual;
    return lattice_.index(glm::ivec3(glm::floor(place / usual + 0.5)) * lattice_.usual);
  }

  const SampleLattice& lattice_;
  std::map<std::pair<std::int64_t, Pair>, Count> counts_;
};

}  // namespace

std::vector<std::array<int, 3>> faces_at_seams(const VoxelRegions& voxels, const SampleLattice& lattice,
                                               const SurfaceNet& net) {
  const Contacts contacts(voxels, lattice);
  std::vector<std::array<int, 3>> cut;
  net.for_each_triangle([&](int a, int b, int c, const SurfaceNet::Edge& edge) {
    if (edge.first == kAir || edge.second == kAir) return;
    const Pair sides = pair_of(voxels.side_of(edge.first), voxels.side_of(edge.second));
    if (sides.first != sides.second && contacts.is_apart(edge, sides)) cut.push_back({a, b, c});
  });
  return cut;
}

void smooth_seams(LatticeNet& net) {
  constexpr int kRounds = 10;
  std::vector<int> other(net.low.rows(), 0);  // number of triangles at each node along which the mesh is not cut
  for (const int node : net.surface.F.reshaped()) ++other[node];
  std::map<int, std::vector<int>> neighbours;  // of each node of a cut; inner neighbours occur twice
  for (const auto& [a, b, c] : net.cut)
    for (const auto& [node, next, last] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
      --other[node];
      neighbours[node].insert(neighbours[node].end(), {next, last});
    }
  std::erase_if(neighbours, [&](const auto& each) { return other[each.first] > 0; });

  const glm::dmat3 back = glm::inverse(net.world_from_lattice.linear);
  const AffineTransform lattice{back, -(back * net.world_from_lattice.offset)};
  const auto at = [&](const AffineTransform& transform, const Eigen::RowVector3d& p) {
    const glm::dvec3 moved = transform * glm::dvec3(p[0], p[1], p[2]);
    return Eigen::RowVector3d(moved.x, moved.y, moved.z);
  };
  Eigen::MatrixX3d V(net.low.rows(), 3);  // positions in the lattice's axes, mm
  for (Eigen::Index i = 0; i < V.rows(); ++i) V.row(i) = at(lattice, net.mesh.V.row(i));
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixX3d before = V;
    for (const auto& [node, around] : neighbours) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (const int next : around) sum += before.row(next);
      V.row(node) = (sum / double(around.size())).cwiseMax(net.low.row(node)).cwiseMin(net.high.row(node));
    }
  }
  for (const auto& [node, around] : neighbours)
    net.mesh.V.row(node) = net.surface.V.row(node) = at(net.world_from_lattice, V.row(node));
}

}  // namespace limber
