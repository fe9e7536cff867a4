// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr int kLeaf = 4;       // largest number of faces in a leaf of the tree
constexpr double kKept = 0.5;  // smallest share of a pair's distance that must be left after a step
constexpr double kSafe = 0.5;  // length of one advance along a step, as a share of the longest safe one
// A step ends after this many advances, even if a longer step would be possible: two parts that slide past each other
// closely would need many tiny advances.
constexpr int kAdvances = 400;

std::uint64_t key_of(int a, int b) { return std::uint64_t(std::min(a, b)) << 32 | std::uint32_t(std::max(a, b)); }

using Corners = std::array<Eigen::Vector3d, 4>;

Corners at(const ContactPair& pair, const NodePositions& x) {
  Corners p;
  for (int a = 0; a < 4; ++a) p[a] = x.row(pair.node[a]);
  return p;
}

// Returns the barycentric coordinates of the point of triangle a, b, c that is nearest to p [Ericson, Real-Time
// Collision Detection, 2005, 5.1.5].
Eigen::Vector3d nearest_in_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / (d4 - d3 + d5 - d6);
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

// Returns the parameters s and t, in [0, 1] along the edges p0 p1 and p2 p3, of the edges' nearest points [Ericson
// 2005, 5.1.9].
std::pair<double, double> nearest_of_edges(const Corners& p) {
  const Eigen::Vector3d u = p[1] - p[0], v = p[3] - p[2], w = p[0] - p[2];
  const double a = u.squaredNorm(), e = v.squaredNorm(), f = v.dot(w), b = u.dot(v), c = u.dot(w);
  const double denominator = a * e - b * b;
  double s = denominator > 0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0;
  double t = e > 0 ? (b * s + f) / e : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0;
  }
  return {s, t};
}

Eigen::Vector4d weights(ContactPair::Kind kind, const Corners& p) {
  if (kind == ContactPair::Kind::PointTriangle) {
    const Eigen::Vector3d s = nearest_in_triangle(p[0], p[1], p[2], p[3]);
    return {1, -s[0], -s[1], -s[2]};
  }
  const auto [s, t] = nearest_of_edges(p);
  return {1 - s, s, t - 1, -t};
}

double distance(ContactPair::Kind kind, const Corners& p) {
  const Eigen::Vector4d w = weights(kind, p);
  return (w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3] * p[3]).norm();
}

// Subtracts the mean motion of the pair's four nodes from `step`, since a common motion does not change the pair's
// distance. Returns an upper limit on how far the remaining step can move the pair's two parts towards each other.
double relative_motion(ContactPair::Kind kind, Corners& step) {
  const Eigen::Vector3d mean = 0.25 * (step[0] + step[1] + step[2] + step[3]);
  double length[4];
  for (int a = 0; a < 4; ++a) length[a] = (step[a] -= mean).norm();
  if (kind == ContactPair::Kind::PointTriangle) return length[0] + std::max({length[1], length[2], length[3]});
  return std::max(length[0], length[1]) + std::max(length[2], length[3]);
}

// Bounding boxes are stored in single precision, so that one SIMD instruction compares four numbers. All comparisons
// include a tolerance for rounding.
using Lanes = Eigen::Array4f;             // SIMD register with x, y, z and 0
constexpr double kRounding = 4 * 1.2e-7;  // upper limit on the rounding error, as a share of the largest coordinate

// The bounds of a set of moving points: of their positions (low, high) and of their steps (slowest, fastest: the
// smallest and the largest with their signs), per axis.
struct Moving {
  Lanes low{INFINITY, INFINITY, INFINITY, 0}, high{-INFINITY, -INFINITY, -INFINITY, 0};
  Lanes slowest = low, fastest = high;
  void add(const Moving& other) {
    low = low.min(other.low), high = high.max(other.high);
    slowest = slowest.min(other.slowest), fastest = fastest.max(other.fastest);
  }
};

Moving around(Moving a, const Moving& b) {
  a.add(b);
  return a;
}

// Returns true if, along one fixed axis, two moving boxes stay more than `reach` apart during their whole motion.
[[gnu::always_inline]] inline bool apart(const Moving& a, const Moving& b, float reach) {
  const Lanes before = a.low - b.high + (a.slowest - b.fastest).min(0.0f);
  const Lanes behind = b.low - a.high + (b.slowest - a.fastest).min(0.0f);
  return before.max(behind).maxCoeff() > reach;
}
}  // namespace

NearestPoints nearest_points(const ContactPair& pair, const NodePositions& x) {
  const Corners p = at(pair, x);
  NearestPoints result;
  result.weight = weights(pair.kind, p);
  const Eigen::Vector3d way =
      result.weight[0] * p[0] + result.weight[1] * p[1] + result.weight[2] * p[2] + result.weight[3] * p[3];
  result.distance = way.norm();
  result.direction = result.distance > 0 ? Eigen::Vector3d(way / result.distance) : Eigen::Vector3d::Zero();
  return result;
}

namespace {
// Returns the largest a, up to `limit`, up to which the distance of a pair stays at least `kept` while its corners move
// along p + a s.
//   now     the distance at a = 0
//   motion  upper limit on how far a whole step (a = 1) moves the pair's two parts towards each other
double largest_advance(ContactPair::Kind kind, Corners p, const Corners& s, double now, double motion, double kept,
                       double limit) {
  double length = 0;
  for (int k = 0; k < kAdvances; ++k) {
    const double advance = kSafe * now / motion;
    if (length + advance >= limit) return limit;
    for (int a = 0; a < 4; ++a) p[a] += advance * s[a];
    now = distance(kind, p);
    if (length > 0 && now < kept) break;  // except for rounding, the first advance leaves at least `kept`
    length += advance;
  }
  return length;
}
}  // namespace

double motion(const ContactPair& pair, const NodePositions& step) {
  Corners s = at(pair, step);
  return relative_motion(pair.kind, s);
}

Approach approach(const ContactPair& pair, const NodePositions& x, const NodePositions& step) {
  return {distance(pair.kind, at(pair, x)), motion(pair, step)};
}

namespace {
// Returns true if the pair's distance may become less than `kept` while its corners move along p + a s, from a = `from`
// to `to`. Uses the distances at both ends and the upper limit `motion` on the distance's change in a whole step (a =
// 1). If these do not decide, halves the range of a. A range too short to be halved gives true.
bool comes_nearer(ContactPair::Kind kind, const Corners& p, const Corners& s, double motion, double kept, double from,
                  double apart_from, double to, double apart_to) {
  constexpr double kShortest = 1.0 / 512;
  if (apart_from + apart_to - (to - from) * motion > 2 * kept) return false;
  if (to - from < kShortest) return true;
  const double middle = 0.5 * (from + to);
  Corners there = p;
  for (int a = 0; a < 4; ++a) there[a] += middle * s[a];
  const double apart = distance(kind, there);
  return apart < kept || comes_nearer(kind, p, s, motion, kept, from, apart_from, middle, apart) ||
         comes_nearer(kind, p, s, motion, kept, middle, apart, to, apart_to);
}

// Returns true if the pair's distance stays at least `kept` while its corners move along p + a s, from a = 0 to
// `limit`.
bool keeps(ContactPair::Kind kind, const Corners& p, const Corners& s, const Approach& approach, double kept,
           double limit) {
  Corners end = p;
  for (int a = 0; a < 4; ++a) end[a] += limit * s[a];
  const double apart = distance(kind, end);
  return apart >= kept && !comes_nearer(kind, p, s, approach.motion, kept, 0, approach.apart, limit, apart);
}
}  // namespace

double largest_step(const ContactPair& pair, const Approach& approach, const NodePositions& x,
                    const NodePositions& step, double limit, double near) {
  const double kept = kKept * std::min(approach.apart, near);
  if (approach.apart - limit * approach.motion > kept) return limit;
  const Corners p = at(pair, x);
  Corners s = at(pair, step);
  if (keeps(pair.kind, p, s, approach, kept, limit)) return limit;
  const double motion = relative_motion(pair.kind, s);
  return largest_advance(pair.kind, p, s, approach.apart, motion, kept, limit);
}

bool is_too_far(const ContactPair& pair, const Approach& approach, const NodePositions& x, const NodePositions& step,
                double near) {
  const double kept = kKept * std::min(approach.apart, near);
  return approach.apart - approach.motion <= kept && !keeps(pair.kind, at(pair, x), at(pair, step), approach, kept, 1);
}

ContactSurface::ContactSurface(const Eigen::MatrixX3i& F, const NodePositions& rest, const std::vector<int>& rigid)
    : rest_(rest),
      rigid_(rigid) {
  std::vector<Eigen::Vector3d> centre;
  std::vector<std::uint64_t> edges;
  for (const auto& f : F.rowwise()) {
    centre.push_back((rest.row(f[0]) + rest.row(f[1]) + rest.row(f[2])).transpose() / 3);
    for (int k = 0; k < 3; ++k) edges.push_back(key_of(f[k], f[(k + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  std::vector<int> order(F.rows());
  for (int f = 0; f < int(F.rows()); ++f) order[f] = f;
  if (F.rows() > 0) grow(order, centre, 0, int(F.rows()));

  // Each node and each edge is tested by only one of the faces that share it: the first in the order of the tree.
  std::vector<char> node_taken(rest.rows(), 0), edge_taken(edges.size(), 0);
  for (const int f : order) {
    Face face{{F(f, 0), F(f, 1), F(f, 2)}, 0, 0};
    for (int k = 0; k < 3; ++k) {
      if (!std::exchange(node_taken[face.node[k]], 1)) face.own_nodes |= 1 << k;
      const auto edge = std::lower_bound(edges.begin(), edges.end(), key_of(face.node[k], face.node[(k + 1) % 3]));
      if (!std::exchange(edge_taken[edge - edges.begin()], 1)) face.own_edges |= 1 << k;
    }
    faces_.push_back(face);
  }
}

// Builds the tree for a range of faces: splits the range in two halves along the longest axis of the bounding box of
// the faces' centres, and builds the left half first.
void ContactSurface::grow(std::vector<int>& order, const std::vector<Eigen::Vector3d>& centre, int begin, int end) {
  const auto here = tree_.size();
  tree_.push_back({begin, end, 0});
  if (end - begin <= kLeaf) return;
  Eigen::AlignedBox3d box;
  for (int k = begin; k < end; ++k) box.extend(centre[order[k]]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int a, int b) {
    return centre[a][axis] != centre[b][axis] ? centre[a][axis] < centre[b][axis] : a < b;
  });
  grow(order, centre, begin, middle);
  tree_[here].right = int(tree_.size());
  grow(order, centre, middle, end);
}

std::vector<ContactPair> ContactSurface::near(const NodePositions& x, const NodePositions& step, double limit,
                                              const Nearness& nearness, const std::vector<char>& asked) const {
  if (faces_.empty()) return {};
  std::vector<Moving> node(x.rows()), face(faces_.size());
  double furthest = 0;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Eigen::RowVector3d motion = limit * step.row(v);
    furthest = std::max(furthest, x.row(v).cwiseAbs().maxCoeff() + motion.cwiseAbs().maxCoeff());
    node[v].low.head<3>() = node[v].high.head<3>() = x.row(v).transpose().array().cast<float>();
    node[v].slowest.head<3>() = node[v].fastest.head<3>() = motion.transpose().array().cast<float>();
  }
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (const int v : faces_[f].node) face[f].add(node[v]);
  const float reach_of_boxes = float(nearness.reach + nearness.margin + kRounding * furthest);

  // Computes the bounds of positions and steps of every branch of the tree. Goes from the last branch to the first, so
  // that the children's bounds, which come later in the list, are known before their parent's.
  std::vector<Moving> branch(tree_.size());
  std::vector<int> rigid_as(tree_.size());
  const auto face_asked = [&](const Face& face) {
    return asked.empty() || asked[face.node[0]] || asked[face.node[1]] || asked[face.node[2]];
  };
  std::vector<char> branch_asked(tree_.size(), 0);
  const auto join = [&](std::size_t b, int rigid, bool first) {
    rigid_as[b] = first || rigid_as[b] == rigid ? rigid : -1;
  };
  for (std::size_t b = tree_.size(); b-- > 0;) {
    if (tree_[b].right) {
      for (const std::size_t below : {b + 1, std::size_t(tree_[b].right)}) {
        branch[b].add(branch[below]);
        branch_asked[b] |= branch_asked[below];
        join(b, rigid_as[below], below == b + 1);
      }
      continue;
    }
    for (int f = tree_[b].begin; f < tree_[b].end; ++f) {
      branch[b].add(face[f]);
      branch_asked[b] |= face_asked(faces_[f]);
      for (int k = 0; k < 3; ++k) join(b, rigid_[faces_[f].node[k]], f == tree_[b].begin && k == 0);
    }
  }

  // Finds the pairs of leaves whose faces may come near each other.
  std::vector<std::pair<int, int>> leaves, open{{0, 0}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    if (!branch_asked[a] && !branch_asked[b]) continue;
    if (rigid_as[a] >= 0 && rigid_as[a] == rigid_as[b]) continue;
    if (a == b) {
      if (tree_[a].right)
        open.insert(open.end(), {{tree_[a].right, tree_[a].right}, {a + 1, tree_[a].right}, {a + 1, a + 1}});
      else leaves.emplace_back(a, a);
      continue;
    }
    if (apart(branch[a], branch[b], reach_of_boxes)) continue;
    const bool split_a =
        tree_[a].right && (!tree_[b].right || tree_[a].end - tree_[a].begin >= tree_[b].end - tree_[b].begin);
    if (split_a) open.insert(open.end(), {{tree_[a].right, b}, {a + 1, b}});
    else if (tree_[b].right) open.insert(open.end(), {{a, tree_[b].right}, {a, b + 1}});
    else leaves.emplace_back(a, b);
  }

  constexpr std::int64_t kGrain = 256;
  std::vector<std::vector<ContactPair>> found((leaves.size() + kGrain - 1) / kGrain);
  const auto one_rigid = [&](const std::array<int, 4>& four) {
    return rigid_[four[0]] >= 0 && rigid_[four[0]] == rigid_[four[1]] && rigid_[four[0]] == rigid_[four[2]] &&
           rigid_[four[0]] == rigid_[four[3]];
  };
  parallel_for(std::ssize(leaves), kGrain, [&](std::int64_t begin, std::int64_t end) {
    auto& mine = found[begin / kGrain];
    // Adds a pair (a point and a triangle, or two edges) if its two parts may come near each other. Callers have
    // already left out most pairs by their bounding boxes.
    const auto consider = [&](ContactPair::Kind kind, const std::array<int, 4>& four) {
      if (one_rigid(four)) return;
      if (!asked.empty() && !asked[four[0]] && !asked[four[1]] && !asked[four[2]] && !asked[four[3]]) return;
      const ContactPair pair{four, kind};
      const auto [apart, motion] = approach(pair, x, step);
      const double nearest = apart - limit * motion - nearness.margin;
      if (nearest < nearness.reach &&
          (nearness.of_rest == INFINITY || nearest < nearness.of_rest * distance(kind, at(pair, rest_))))
        mine.push_back(pair);
    };
    const auto points = [&](const Face& a, const Face& b, const Moving& all_of_b) {
      for (int k = 0; k < 3; ++k) {
        const int v = a.node[k];
        if (!(a.own_nodes >> k & 1) || v == b.node[0] || v == b.node[1] || v == b.node[2]) continue;
        if (!apart(node[v], all_of_b, reach_of_boxes))
          consider(ContactPair::Kind::PointTriangle, {v, b.node[0], b.node[1], b.node[2]});
      }
    };
    const auto edges = [&](const Face& a, const Face& b) {
      for (int k = 0; k < 3; ++k) {
        if (!(a.own_edges >> k & 1)) continue;
        const int v = a.node[k], w = a.node[(k + 1) % 3];
        const Moving edge = around(node[v], node[w]);
        for (int l = 0; l < 3; ++l) {
          const int other_v = b.node[l], other_w = b.node[(l + 1) % 3];
          if (!(b.own_edges >> l & 1) || v == other_v || v == other_w || w == other_v || w == other_w) continue;
          if (!apart(edge, around(node[other_v], node[other_w]), reach_of_boxes))
            consider(ContactPair::Kind::EdgeEdge, {v, w, other_v, other_w});
        }
      }
    };
    for (auto l = begin; l < end; ++l) {
      const Branch &a = tree_[leaves[l].first], &b = tree_[leaves[l].second];
      for (int i = a.begin; i < a.end; ++i)
        for (int j = leaves[l].first == leaves[l].second ? i + 1 : b.begin; j < b.end; ++j) {
          if (apart(face[i], face[j], reach_of_boxes) || !(face_asked(faces_[i]) || face_asked(faces_[j]))) continue;
          points(faces_[i], faces_[j], face[j]);
          points(faces_[j], faces_[i], face[i]);
          edges(faces_[i], faces_[j]);
        }
    }
  });
  std::vector<ContactPair> pairs;
  for (const auto& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  return pairs;
}

}  // namespace limber
