// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/improve.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

#include "core/mesh/voxels_in_tet.h"

namespace limber {

namespace {

using Point = Eigen::Vector3d;

// Badness (cosine of the smallest dihedral angle) above which a tet counts as flat: its smallest angle is below 6
// degrees. Flat tets are worth the slower search in Improver::move.
const double kFlat = std::cos(6 * std::numbers::pi / 180);

// Returns the badness of a tet: the cosine of its smallest dihedral angle, or 2 if its volume is not positive. A
// smaller value is better.
double badness(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point ab = b - a, ac = c - a, ad = d - a, bc = c - b, bd = d - b;
  const Point normal[4] = {bc.cross(bd), ad.cross(ac), ab.cross(ad),
                           ac.cross(ab)};  // outward normals of the faces opposite to corners a, b, c, d
  if (normal[3].dot(ad) >= 0) return 2;
  double length[4], worst = -1;
  for (int i = 0; i < 4; ++i) length[i] = normal[i].norm();
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) worst = std::max(worst, -normal[i].dot(normal[j]) / (length[i] * length[j]));
  return std::isfinite(worst) ? worst : 2;
}

constexpr int kAskEvery = 256;  // number of nodes (about 20 ms) between two checks for cancellation

class Improver {
 public:
  // Converts the nodes to lattice axes, in which the boxes of the net's nodes are given.
  //   may_lose  number of tissue voxels that may end up outside the mesh
  Improver(TetMesh& mesh, const LatticeNet& net, const VoxelRegions& voxels, std::int64_t may_lose)
      : mesh_(mesh),
        net_(net),
        voxels_(voxels),
        may_lose_(may_lose),
        first_(mesh.V.rows() + 1, 0),
        V_(mesh.V.rows()),
        on_skin_(mesh.V.rows(), 0) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) turn_(i, j) = net.world_from_lattice.linear[j][i];
    offset_ << net.world_from_lattice.offset.x, net.world_from_lattice.offset.y, net.world_from_lattice.offset.z;
    mirrored_ = turn_.determinant() < 0;
    const Eigen::Matrix3d back = turn_.inverse();
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) V_[i] = back * (mesh.V.row(i).transpose() - offset_);

    const AffineTransform to_voxel = voxel_from_world(voxels.grid);
    voxel_from_lattice_ = {to_voxel.linear * net.world_from_lattice.linear, to_voxel * net.world_from_lattice.offset};
    for (Eigen::Index i = 0; i < net.surface.F.rows(); ++i)
      if (net.surface.sides[i][0] == RegionSurface::kAir || net.surface.sides[i][1] == RegionSurface::kAir)
        for (const int corner : net.surface.F.row(i)) on_skin_[corner] = 1;

    for (const auto& tet : mesh.T.rowwise())
      for (const int corner : tet) ++first_[corner + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    tet_.resize(first_.back());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (Eigen::Index tet = 0; tet < mesh.T.rows(); ++tet)
      for (const int corner : mesh.T.row(tet)) tet_[next[corner]++] = static_cast<int>(tet);
  }

  // Moves the nodes of tets whose badness is above `enough`, until no move helps or `most` sweeps over the mesh are
  // done. After the first sweep, tests only the tets around nodes that moved.
  int sweeps(int most, double enough, double reach, Progress& progress) {
    std::vector<int> tets(mesh_.T.rows());
    std::iota(tets.begin(), tets.end(), 0);
    int moves = 0;
    for (int sweep = 0; sweep < most && !tets.empty(); ++sweep) {
      std::vector<int> nodes;
      for (const int tet : tets)
        if (badness_of(mesh_.T.row(tet)) > enough)
          nodes.insert(nodes.end(), mesh_.T.row(tet).begin(), mesh_.T.row(tet).end());
      keep_once(nodes);
      tets.clear();
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (i % kAskEvery == 0) progress.update("tetrahedra", 0.8);
        const int node = nodes[i];
        if (!move(node, enough, reach)) continue;
        ++moves;
        tets.insert(tets.end(), tet_.begin() + first_[node], tet_.begin() + first_[node + 1]);
      }
      keep_once(tets);
    }
    return moves;
  }

  // Writes only the moved nodes back to the mesh, so that the positions of all others stay equal bit by bit.
  void write() {
    for (const int node : moved_) mesh_.V.row(node) = (turn_ * V_[node] + offset_).transpose();
  }

 private:
  double badness_of(const Eigen::RowVector4i& tet) const {
    const int c = mirrored_ ? 2 : 1, b = mirrored_ ? 1 : 2;
    return badness(V_[tet[0]], V_[tet[c]], V_[tet[b]], V_[tet[3]]);
  }

  // Returns the largest badness of the tets around a node. Stops early once a tet exceeds `limit`.
  double worst_around(int node, double limit = 2) const {
    double worst = -1;
    for (int i = first_[node]; i < first_[node + 1] && worst <= limit; ++i)
      worst = std::max(worst, badness_of(mesh_.T.row(tet_[i])));
    return worst;
  }

  static void keep_once(std::vector<int>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  bool is_tissue(const glm::ivec3& v) const {
    const int brick = voxels_.tissue.brick_at(v);
    return brick >= 0 && (voxels_.tissue.bricks()[brick].mask[v.z & 7] >> ((v.x & 7) + 8 * (v.y & 7)) & 1);
  }

  // Collects the grid indices, sorted, of the tissue voxels in the tets around a node.
  void voxels_around(int node, std::vector<std::int64_t>& places) const {
    places.clear();
    const Grid& grid = voxels_.grid;
    for (int i = first_[node]; i < first_[node + 1]; ++i) {
      glm::dvec3 corner[4];
      for (int k = 0; k < 4; ++k) {
        const Point& p = V_[mesh_.T(tet_[i], k)];
        corner[k] = voxel_from_lattice_ * glm::dvec3(p[0], p[1], p[2]);
      }
      if (glm::dot(glm::cross(corner[1] - corner[0], corner[2] - corner[0]), corner[3] - corner[0]) < 0)
        std::swap(corner[0], corner[1]);
      for_each_row_in_tet(corner, grid, 0, grid.size.z - 1, [&](glm::ivec3 v, const glm::ivec3& last) {
        for (; v.x <= last.x; ++v.x)
          if (is_tissue(v)) places.push_back(grid.index(v));
      });
    }
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
  }

  // Returns how many voxels of `before` the tets around a node no longer contain.
  std::int64_t lost_around(int node, const std::vector<std::int64_t>& before) const {
    if (!on_skin_[node]) return 0;
    std::vector<std::int64_t> after, lost;
    voxels_around(node, after);
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(lost));
    return std::ssize(lost);
  }

  // Searches for the node position with the least badness and returns it. Calls accept() with the node at each
  // candidate position; false rejects that position.
  template <class Accept>
  Point search(int node, double reach, const Accept& accept) {
    Point& place = V_[node];
    Point low = Point::Constant(-1e300), high = Point::Constant(1e300);
    if (node < net_.low.rows()) low = net_.low.row(node).transpose(), high = net_.high.row(node).transpose();
    Point middle = Point::Zero();
    double size = 0;
    int count = 0;
    for (int i = first_[node]; i < first_[node + 1]; ++i)
      for (const int corner : mesh_.T.row(tet_[i]))
        if (corner != node) middle += V_[corner], size += (V_[corner] - place).norm(), ++count;
    middle /= count, size /= count;

    const Point start = place;
    Point best_place = start;
    double best = worst_around(node);
    const auto attempt = [&](const Point& there) {
      place = there.cwiseMax(low).cwiseMin(high);
      const double now = worst_around(node, best);
      if (now < best && accept()) best = now, best_place = place;
    };
    for (const double share : {1.0, 0.5, 0.2}) attempt(start + share * (middle - start));
    for (double step = reach * size; step > 0.02 * size; step *= 0.5) {
      const Point from = best_place;
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) attempt(from + side * step * Point::Unit(axis));
    }
    place = start;
    return best_place;
  }

  bool move(int node, double enough, double reach) {
    const double worst = worst_around(node);
    if (worst <= enough) return false;
    const Point start = V_[node];
    const Point best = search(node, reach, [] { return true; });
    if (best == start) return false;
    std::vector<std::int64_t> before;
    if (on_skin_[node]) voxels_around(node, before);
    if (settle(node, best, worst, before)) return true;
    if (worst <= kFlat) return false;
    // The tet is flat, so it is worth the time to count the voxels that leave the mesh at every candidate position.
    const Point kept = search(node, reach, [&] { return lost_around(node, before) <= may_lose_; });
    return kept != start && settle(node, kept, worst, before);
  }

  // Moves a node to `there`, or 1/2 or 1/4 of the way if the whole way would leave too many voxels outside the mesh.
  // Returns whether the node moved.
  bool settle(int node, const Point& there, double worst, const std::vector<std::int64_t>& before) {
    Point& place = V_[node];
    const Point start = place;
    for (const double share : {1.0, 0.5, 0.25}) {
      place = start + share * (there - start);
      if (worst_around(node, worst) >= worst) continue;
      const std::int64_t lost = lost_around(node, before);
      if (lost > may_lose_) continue;
      may_lose_ -= lost;
      moved_.push_back(node);
      return true;
    }
    place = start;
    return false;
  }

  TetMesh& mesh_;
  const LatticeNet& net_;
  const VoxelRegions& voxels_;
  AffineTransform voxel_from_lattice_;
  std::int64_t may_lose_;
  std::vector<int> first_, tet_;  // indices of the tets around node i: tet_[first_[i]] .. tet_[first_[i + 1] - 1]
  std::vector<Point> V_;
  std::vector<std::uint8_t> on_skin_;
  std::vector<int> moved_;
  Eigen::Matrix3d turn_;
  Eigen::Vector3d offset_;
  bool mirrored_ = false;
};

}  // namespace

int improve(TetMesh& mesh, const LatticeNet& net, const VoxelRegions& voxels, const ImproveSettings& settings,
            Progress& progress) {
  const double spare = std::max(0.0, net.covered - settings.least_covered);
  Improver improver(mesh, net, voxels, static_cast<std::int64_t>(spare * double(voxels.tissue.size())));
  const double enough = std::cos(settings.enough_degrees * std::numbers::pi / 180);
  int moves = 0;
  // The flattest tets come first: all tets share one limit on the number of voxels that may leave the mesh.
  for (const double goal : {kFlat, enough}) moves += improver.sweeps(settings.sweeps, goal, 0.3, progress);
  improver.write();
  return moves;
}

}  // namespace limber
