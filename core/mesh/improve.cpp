// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/improve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <unordered_map>

#include <Eigen/Geometry>

namespace limber {

namespace {

using Point = Eigen::Vector3d;

// Badness (cosine of the smallest dihedral angle) of a tet with a dihedral angle of 6 degrees. A tet with a larger
// badness counts as flat.
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

// A node of the skin stays within this distance of the surface that was fitted to the voxels, as a share of the mean
// length of the edges at the node.
constexpr double kOffSkin = 0.05;

constexpr int kAskEvery = 256;  // number of nodes (about 20 ms) between two checks for cancellation

class Improver {
 public:
  // Converts the nodes to lattice axes, in which the boxes of the net's nodes are given.
  Improver(TetMesh& mesh, const LatticeNet& net)
      : mesh_(mesh),
        net_(net),
        first_(mesh.V.rows() + 1, 0),
        V_(mesh.V.rows()) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) turn_(i, j) = net.world_from_lattice.linear[j][i];
    offset_ << net.world_from_lattice.offset.x, net.world_from_lattice.offset.y, net.world_from_lattice.offset.z;
    mirrored_ = turn_.determinant() < 0;
    const Eigen::Matrix3d back = turn_.inverse();
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) V_[i] = back * (mesh.V.row(i).transpose() - offset_);

    for (Eigen::Index i = 0; i < net.surface.F.rows(); ++i) {
      const auto [front, back_side] = net.surface.sides[i];
      if (front != RegionSurface::kAir && back_side != RegionSurface::kAir) continue;
      const Eigen::RowVector3i corner = net.surface.F.row(i);
      const Point normal = (V_[corner[1]] - V_[corner[0]]).cross(V_[corner[2]] - V_[corner[0]]);
      for (const int node : corner) {
        Skin& skin = skin_.try_emplace(node, Skin{V_[node], Point::Zero()}).first->second;
        skin.normal += front == RegionSurface::kAir ? normal : Point(-normal);
      }
    }
    for (auto& [node, skin] : skin_) skin.normal.normalize();

    for (const auto& tet : mesh.T.rowwise())
      for (const int corner : tet) ++first_[corner + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    tet_.resize(first_.back());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (Eigen::Index tet = 0; tet < mesh.T.rows(); ++tet)
      for (const int corner : mesh.T.row(tet)) tet_[next[corner]++] = static_cast<int>(tet);
  }

  // Moves the nodes of tets whose badness is above `enough`, until no move helps or `most` sweeps over the mesh are
  // done. After the first sweep, only the tets around moved nodes are tested.
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

  // Writes only the moved nodes back to the mesh, so that the positions of all others stay equal, bit for bit.
  void write() {
    for (const int node : moved_) mesh_.V.row(node) = (turn_ * V_[node] + offset_).transpose();
  }

 private:
  struct Skin {
    Point first, normal;  // position before any move, and the surface's unit normal there
  };

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

  // Returns the position nearest to `there` to which the node may move: inside its box and, for a node of the skin, at
  // most kOffSkin away from its first position along the skin's normal. Returns nothing if no position near `there`
  // meets both limits.
  std::optional<Point> allowed(int node, Point there, double size) const {
    if (node >= net_.low.rows()) return there;
    const Point low = net_.low.row(node).transpose(), high = net_.high.row(node).transpose();
    there = there.cwiseMax(low).cwiseMin(high);
    const auto skin = skin_.find(node);
    if (skin == skin_.end()) return there;
    const double most = kOffSkin * size;
    const auto off = [&] { return (there - skin->second.first).dot(skin->second.normal); };
    for (int attempt = 0; attempt < 3 && std::abs(off()) > most; ++attempt) {
      there -= (off() - std::copysign(most, off())) * skin->second.normal;
      there = there.cwiseMax(low).cwiseMin(high);
    }
    if (std::abs(off()) > 1.01 * most) return std::nullopt;
    return there;
  }

  // Moves a node to the position with the smallest badness around it. Returns true if the node moved.
  bool move(int node, double enough, double reach) {
    Point& place = V_[node];
    const Point start = place;
    double best = worst_around(node);
    if (best <= enough) return false;
    Point middle = Point::Zero();
    double size = 0;
    int count = 0;
    for (int i = first_[node]; i < first_[node + 1]; ++i)
      for (const int corner : mesh_.T.row(tet_[i]))
        if (corner != node) middle += V_[corner], size += (V_[corner] - place).norm(), ++count;
    middle /= count, size /= count;

    Point best_place = start;
    const auto attempt = [&](const Point& there) {
      const std::optional<Point> candidate = allowed(node, there, size);
      if (!candidate) return;
      place = *candidate;
      const double now = worst_around(node, best);
      if (now < best) best = now, best_place = place;
    };
    for (const double share : {1.0, 0.5, 0.2}) attempt(start + share * (middle - start));
    for (double step = reach * size; step > 0.02 * size; step *= 0.5) {
      const Point from = best_place;
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) attempt(from + side * step * Point::Unit(axis));
    }
    place = best_place;
    if (best_place != start) moved_.push_back(node);
    return best_place != start;
  }

  TetMesh& mesh_;
  const LatticeNet& net_;
  std::vector<int> first_, tet_;  // the tets around node i are tet_[first_[i]] to tet_[first_[i + 1] - 1]
  std::vector<Point> V_;
  std::unordered_map<int, Skin> skin_;  // by node, for the nodes of the skin (the surface at air)
  std::vector<int> moved_;
  Eigen::Matrix3d turn_;
  Eigen::Vector3d offset_;
  bool mirrored_ = false;
};

}  // namespace

int improve(TetMesh& mesh, const LatticeNet& net, const ImproveSettings& settings, Progress& progress) {
  Improver improver(mesh, net);
  const double enough = std::cos(settings.enough_degrees * std::numbers::pi / 180);
  int moves = 0;
  // Improves the flattest tets first, since a node that has moved for one tet can move less for the next.
  for (const double goal : {kFlat, enough}) moves += improver.sweeps(settings.sweeps, goal, 0.3, progress);
  improver.write();
  return moves;
}

}  // namespace limber
