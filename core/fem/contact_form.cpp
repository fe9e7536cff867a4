// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/contact_form.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/parallel.h"

namespace limber {

namespace {
// A pair's thickness h (the distance below which its two parts are pushed apart) is at most this share of the parts'
// distance at rest.
constexpr double kOfRest = 0.5;
// Pairs whose distance is below this many thicknesses h are put into the matrix's sparsity pattern. The number is above
// 1, so that pairs are in the pattern before they touch.
constexpr double kSoon = 1.6;
// A pair whose distance is below this share of the thickness h must be in the matrix's sparsity pattern. If it is not,
// the pattern is analysed again.
constexpr double kPressed = 0.6;
// A step must keep at least half of a pair's distance. For pairs further apart than kNear times the largest thickness
// H, only half of kNear * H must be left, since the barrier is almost zero there.
constexpr double kNear = 0.5;
// If a node's motion differs from the motion that was last searched for pairs by less than this share of the largest
// thickness H, the pairs found earlier stay valid. If it differs by more, the pairs near the node are searched again.
constexpr double kAbout = 0.2;
// Two edges count as parallel if their squared cross product is below this share of the product of their squared
// lengths at rest.
constexpr double kParallel = 1e-3;
// The energy of edges fades out as they become parallel. For an edge of the skin and one of an object, the factor stays
// at least this: an object's position is prescribed, so without a force between the edges it would come so close that
// no step is possible.
constexpr double kLeastFade = 0.1;
constexpr std::int64_t kGrain = 2048;

// The barrier b(d / h) and its first and second derivatives by the distance d.
struct Barrier {
  double value, slope, curvature;
};
Barrier barrier(double d, double h) {
  const double t = d / h, off = t - 1, ln = std::log(t);
  return {-off * off * ln, -off * (2 * ln + off / t) / h, (-2 * ln - 4 * off / t + off * off / (t * t)) / (h * h)};
}

// Returns the mean area of skin per node: the total area of its triangles divided by the number of their nodes.
double mean_area(const Eigen::MatrixX3i& F, const NodePositions& V, int skin_nodes) {
  double sum = 0;
  std::vector<char> used(V.rows(), 0);
  for (const auto& f : F.rowwise()) {
    if (f[0] >= skin_nodes) continue;
    sum += 0.5 * Eigen::Vector3d(V.row(f[1]) - V.row(f[0])).cross(Eigen::Vector3d(V.row(f[2]) - V.row(f[0]))).norm();
    for (const int node : f) used[node] = 1;
  }
  return sum / double(std::max<std::ptrdiff_t>(std::count(used.begin(), used.end(), 1), 1));
}

double share_of(ContactPair::Kind kind) { return kind == ContactPair::Kind::EdgeEdge ? 0.5 : 1; }
}  // namespace

ContactForm::ContactForm(const Eigen::MatrixX3i& F, const NodePositions& rest, const std::vector<int>& rigid,
                         const ContactSettings& settings)
    : surface_(F, rest, rigid),
      rest_(rest),
      settings_(settings),
      scale_(settings.barrier_kpa * settings.thickness_mm * mean_area(F, rest, settings.skin_nodes)) {}

double ContactForm::thickness(const ContactPair& pair) const {
  return std::min(has_object(pair) ? settings_.object_mm : settings_.thickness_mm,
                  kOfRest * nearest_points(pair, rest_).distance);
}

bool ContactForm::has_object(const ContactPair& pair) const {
  return std::any_of(pair.node.begin(), pair.node.end(), [&](int node) { return node >= settings_.skin_nodes; });
}

void ContactForm::add_push(const NodePositions& step, std::span<const int> unknown, NodePositions& gradient) const {
  for (const Touch& touch : touching_) {
    double nearer = 0;
    for (int a = 0; a < 4; ++a)
      if (const int node = touch.pair.node[a]; unknown[node] < 0)
        nearer += step.row(node).dot(touch.way.col(a).transpose());
    if (nearer == 0) continue;
    for (int a = 0; a < 4; ++a)
      if (const int node = touch.pair.node[a]; unknown[node] >= 0)
        gradient.row(node) += touch.curvature * nearer * touch.way.col(a).transpose();
  }
}

ContactForm::ObjectForces ContactForm::object_forces() const {
  ObjectForces forces{NodePositions::Zero(rest_.rows(), 3), std::vector<int>(rest_.rows(), -1)};
  std::vector<double> most(rest_.rows(), 0);
  for (const Touch& touch : touching_) {
    if (!has_object(touch.pair)) continue;
    const auto& nodes = touch.pair.node;
    const int object = *std::max_element(nodes.begin(), nodes.end());
    for (int a = 0; a < 4; ++a) {
      const Eigen::RowVector3d force =
          -(touch.slope * touch.way.col(a) + touch.faded * touch.fading.col(a)).transpose();
      forces.force.row(nodes[a]) += force;
      if (force.norm() > most[nodes[a]]) most[nodes[a]] = force.norm(), forces.pressed_by[nodes[a]] = object;
    }
  }
  return forces;
}

ContactForm::Fade ContactForm::fade(const ContactPair& pair, const NodePositions& x) const {
  Fade fade{1, Eigen::Matrix<double, 3, 4>::Zero()};
  if (pair.kind == ContactPair::Kind::PointTriangle) return fade;
  const auto edge = [&](const NodePositions& p, int k) {
    return Eigen::Vector3d((p.row(pair.node[k + 1]) - p.row(pair.node[k])).transpose());
  };
  const Eigen::Vector3d u = edge(x, 0), v = edge(x, 2);
  const double c = u.cross(v).squaredNorm(),
               full = kParallel * edge(rest_, 0).squaredNorm() * edge(rest_, 2).squaredNorm();
  if (c >= full) return fade;
  const double least = has_object(pair) ? kLeastFade : 0, t = c / full, slope = (1 - least) * (2 - 2 * t) / full;
  fade.value = least + (1 - least) * (2 - t) * t;
  fade.slope.col(1) = slope * 2 * (v.squaredNorm() * u - u.dot(v) * v);
  fade.slope.col(3) = slope * 2 * (u.squaredNorm() * v - u.dot(v) * u);
  fade.slope.col(0) = -fade.slope.col(1);
  fade.slope.col(2) = -fade.slope.col(3);
  return fade;
}

void ContactForm::build_broad_phase(const NodePositions& x, const NodePositions& step, double limit) {
  NodePositions end = x + limit * step;
  const bool ends_there = end.rows() == watched_to_.rows() && end == watched_to_;
  if (ends_there && (limit == 0 || (limit == watched_limit_ && x == watched_from_))) return;
  watched_to_.resize(0, 3);  // stays empty if the search below throws, so that the next call searches again
  extend_broad_phase(x, end);

  // Drops pairs of earlier searches whose two parts stay apart during the new motion. There are such pairs when the new
  // motion is shorter than the motion that was searched.
  const double about = kAbout * settings_.thickness_mm;
  std::vector<std::vector<Watched>> near((known_.size() + kGrain - 1) / kGrain), still_known(near.size());
  parallel_for(std::ssize(known_), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k) {
      Watched& each = known_[k];
      each.approach = approach(each.pair, x, step);
      const double nearest = each.approach.apart - limit * each.approach.motion;
      if (nearest < each.thickness) near[begin / kGrain].push_back(each);
      if (nearest < each.thickness + 4 * about) still_known[begin / kGrain].push_back(each);
    }
  });
  const auto join = [](const std::vector<std::vector<Watched>>& parts, std::vector<Watched>& all) {
    all.clear();
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  };
  join(near, watched_);
  join(still_known, known_);
  blocked_.assign(watched_.size(), 0);
  watched_from_ = x;
  watched_to_ = std::move(end);
  watched_limit_ = limit;
}

// A new motion often differs from the searched motion (known_from_ -> known_to_) at few nodes only, or covers only a
// part of it. So the searched motion is cut to its section nearest to the new motion, and pairs are searched again only
// around nodes that move differently from that section.
void ContactForm::extend_broad_phase(const NodePositions& from, const NodePositions& to) {
  const double about = kAbout * settings_.thickness_mm;
  const auto is_away = [&](const NodePositions& a, const NodePositions& b) -> Eigen::Array<bool, Eigen::Dynamic, 1> {
    return (a - b).rowwise().squaredNorm().array() > about * about;
  };
  Eigen::Array<bool, Eigen::Dynamic, 1> changed;
  if (known_from_.rows() != from.rows()) {
    known_.clear();
    known_from_ = from;
    known_to_ = to;
    changed.setConstant(from.rows(), true);
  } else {
    const NodePositions way = known_to_ - known_from_;
    const auto nearest_on_way = [&](const NodePositions& place) {
      const double squared = way.squaredNorm(),
                   on_way =
                       squared > 0 ? std::clamp((place - known_from_).cwiseProduct(way).sum() / squared, 0.0, 1.0) : 0;
      NodePositions nearest;
      std::ptrdiff_t least = place.rows() + 1;
      for (const double share : {0.0, 1.0, on_way}) {
        NodePositions there = known_from_ + share * way;
        if (const auto away = is_away(place, there).count(); away < least) least = away, nearest = std::move(there);
      }
      return nearest;
    };
    NodePositions near_from = nearest_on_way(from), near_to = nearest_on_way(to);
    known_from_ = std::move(near_from);
    known_to_ = std::move(near_to);
    changed = is_away(from, known_from_) || is_away(to, known_to_);
    if (!changed.any()) return;
    for (Eigen::Index v = 0; v < from.rows(); ++v)
      if (changed[v]) known_from_.row(v) = from.row(v), known_to_.row(v) = to.row(v);
    std::erase_if(known_, [&](const Watched& each) {
      const auto& node = each.pair.node;
      return changed[node[0]] || changed[node[1]] || changed[node[2]] || changed[node[3]];
    });
  }
  NodePositions steps = known_to_ - known_from_, begins;
  begins.swap(known_from_);  // empty during the search, so that the next call searches again if this one throws
  for (const ContactPair& pair :
       surface_.near(begins, steps, 1, {settings_.thickness_mm, kOfRest, 2 * about}, {changed.begin(), changed.end()}))
    known_.push_back({pair, thickness(pair), {}});
  begins.swap(known_from_);
}

ContactForm::Bound ContactForm::largest_step(const NodePositions& x, const NodePositions& step, double limit) const {
  const double near = kNear * settings_.thickness_mm;
  std::vector<Bound> of_block((watched_.size() + kGrain - 1) / kGrain, {limit, {-1, -1, -1, -1}});
  parallel_for(std::ssize(watched_), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Bound& bound = of_block[begin / kGrain];
    for (auto k = begin; k < end; ++k) {
      const auto& [pair, h, approach] = watched_[k];
      if (const double length = limber::largest_step(pair, approach, x, step, bound.length, near);
          length < bound.length)
        bound = {length, pair.node};
    }
  });
  Bound bound{limit, {-1, -1, -1, -1}};
  for (const Bound& block : of_block)
    if (block.length < bound.length) bound = block;
  return bound;
}

void ContactForm::mark_blocking_pairs(const NodePositions& x, const NodePositions& step,
                                      const std::vector<char>& changed) {
  const double near = kNear * settings_.thickness_mm;
  parallel_for(std::ssize(watched_), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k) {
      const auto& [pair, h, watched] = watched_[k];
      if (changed.empty()) blocked_[k] = is_too_far(pair, watched, x, step, near);
      else if (changed[pair.node[0]] || changed[pair.node[1]] || changed[pair.node[2]] || changed[pair.node[3]])
        blocked_[k] = is_too_far(pair, {watched.apart, motion(pair, step)}, x, step, near);
    }
  });
}

double ContactForm::value(const NodePositions& x) const {
  return parallel_sum(std::ssize(watched_), kGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto k = begin; k < end; ++k) {
      const auto& [pair, h, approach] = watched_[k];
      const double d = nearest_points(pair, x).distance;
      if (d >= h) continue;
      if (!(d > 0)) return double(INFINITY);
      sum += scale_ * share_of(pair.kind) * barrier(d, h).value * fade(pair, x).value;
    }
    return sum;
  });
}

void ContactForm::update_active_pairs(const NodePositions& x) {
  touching_.clear();
  tightest_ = 1;
  for (const auto& [pair, h, approach] : watched_) {
    const NearestPoints nearest = nearest_points(pair, x);
    if (nearest.distance >= h) continue;
    tightest_ = std::min(tightest_, nearest.distance / h);
    const Barrier b = barrier(nearest.distance, h);
    const Fade faded = fade(pair, x);
    const double scale = scale_ * share_of(pair.kind);
    Touch touch{pair,
                scale * b.slope * faded.value,
                scale * b.curvature * faded.value,
                nearest.distance < kPressed * h,
                {},
                faded.slope,
                scale * b.value,
                {},
                {0, 1, 2, 3}};
    for (int a = 0; a < 4; ++a) touch.way.col(a) = nearest.weight[a] * nearest.direction;
    touching_.push_back(touch);
  }
}

void ContactForm::add_gradient(NodePositions& gradient) const {
  for (const Touch& touch : touching_)
    for (int a = 0; a < 4; ++a)
      gradient.row(touch.pair.node[a]) +=
          (touch.slope * touch.way.col(a) + touch.faded * touch.fading.col(a)).transpose();
}

// Adds only the term of the Hessian that contains the second derivative of the barrier by a pair's distance. The other
// terms come from the rotation of the shortest line between the pair's two parts; they are left out because they would
// make the Hessian indefinite.
void ContactForm::add_curvature(std::span<double> values) const {
  for (const Touch& touch : touching_)
    for (int a = 0, k = 0; a < 4; ++a)
      for (int b = 0; b <= a; ++b, ++k) {
        const Cholesky::Place& place = touch.place[k];
        if (place.at < 0) continue;
        const Eigen::Vector3d row = touch.way.col(touch.order[a]),
                              column = touch.curvature * touch.way.col(touch.order[b]);
        double* at = values.data() + place.at;
        for (int c = 0; c < 3; ++c, at += place.stride)
          for (int r = 0; r < 3; ++r) at[r] += row[r] * column[c];
      }
}

void ContactForm::add_sparsity(BlockGraphBuilder& graph, std::span<const int> unknown, const NodePositions& x) {
  for (const auto& [pair, h, approach] : watched_) {
    if (nearest_points(pair, x).distance >= kSoon * h) continue;
    std::array<int, 4> element;
    for (int a = 0; a < 4; ++a) element[a] = unknown[pair.node[a]];
    graph.add(element);
  }
}

bool ContactForm::assign_nodes(const Cholesky& matrix, std::span<const int> unknown) {
  const auto rank = [&](int node) { return unknown[node] < 0 ? -1 : matrix.rank(unknown[node]); };
  for (Touch& touch : touching_) {
    bool unforeseen = false;
    std::sort(touch.order.begin(), touch.order.end(), [&](int a, int b) {
      const int rank_a = rank(touch.pair.node[a]), rank_b = rank(touch.pair.node[b]);
      return rank_a != rank_b ? rank_a < rank_b : a < b;
    });
    for (int a = 0, k = 0; a < 4; ++a)
      for (int b = 0; b <= a; ++b, ++k) {
        const int row = unknown[touch.pair.node[touch.order[a]]], column = unknown[touch.pair.node[touch.order[b]]];
        touch.place[k] = row < 0 || column < 0 ? Cholesky::Place{-1, 0} : matrix.place(row, column);
        unforeseen = unforeseen || (row >= 0 && column >= 0 && touch.place[k].at < 0);
      }
    if (!unforeseen) continue;
    if (touch.pressed) return false;
    // The number of nodes of the pair's first part: one for a point, two for an edge.
    const int sides = touch.pair.kind == ContactPair::Kind::EdgeEdge ? 2 : 1;
    for (int a = 0, k = 0; a < 4; ++a)
      for (int b = 0; b <= a; ++b, ++k)
        if ((touch.order[a] < sides) != (touch.order[b] < sides)) touch.place[k].at = -1;
  }
  return true;
}

}  // namespace limber
