// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/contact_form.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/fem/fem_energy.h"
#include "tests/support/tet_shapes.h"

using namespace limber;

namespace {
using Kind = ContactPair::Kind;

NodePositions random_places(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-size, size);
  NodePositions places(count, 3);
  for (double& each : places.reshaped()) each = share(random);
  return places;
}

// The surfaces of two boxes with a gap of `gap` mm along z.
struct TwoBoxes {
  TetMesh mesh = kuhn_box(3, 3, 2, {0, 0, 0}, {9, 9, 4});
  NodePositions rest;
  Eigen::MatrixX4i T;
  Eigen::MatrixX3i F;

  explicit TwoBoxes(double gap) {
    const int n = int(mesh.V.rows());
    rest.resize(2 * n, 3);
    rest << mesh.V, mesh.V.rowwise() + Eigen::RowVector3d(1.1, 0.7, 4 + gap);
    T.resize(2 * mesh.T.rows(), 4);
    T << mesh.T, mesh.T.array() + n;
    F = boundary_of(T);
  }
  std::vector<int> free() const { return std::vector<int>(rest.rows(), -1); }
  NodePositions upper_by(const Eigen::RowVector3d& by) const {
    NodePositions step = NodePositions::Zero(rest.rows(), 3);
    step.bottomRows(rest.rows() / 2).rowwise() = by;
    return step;
  }
};

using Key = std::pair<int, std::array<int, 4>>;
Key key(ContactPair pair) {
  std::sort(pair.node.begin() + 2, pair.node.end());
  if (pair.kind == Kind::PointTriangle) std::sort(pair.node.begin() + 1, pair.node.end());
  else {
    if (pair.node[0] > pair.node[1]) std::swap(pair.node[0], pair.node[1]);
    if (pair.node[0] > pair.node[2]) pair.node = {pair.node[2], pair.node[3], pair.node[0], pair.node[1]};
  }
  return {int(pair.kind), pair.node};
}
}  // namespace

TEST_CASE("contact: the nearest points are the nearest of all, for points and triangles and for edges") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  for (unsigned seed = 0; seed < 200; ++seed) {
    const NodePositions x = random_places(4, 1, seed);
    for (const Kind kind : {Kind::PointTriangle, Kind::EdgeEdge}) {
      const NearestPoints nearest = nearest_points({{0, 1, 2, 3}, kind}, x);
      CHECK(std::abs(nearest.weight.sum()) < 1e-12);
      CHECK((x.transpose() * nearest.weight - nearest.distance * nearest.direction).norm() < 1e-12);
      for (int k = 0; k < 50; ++k) {
        double s = share(random), t = share(random);
        if (kind == Kind::PointTriangle && s + t > 1) s = 1 - s, t = 1 - t;
        const Eigen::Vector4d w =
            kind == Kind::PointTriangle ? Eigen::Vector4d(1, s + t - 1, -s, -t) : Eigen::Vector4d(1 - s, s, t - 1, -t);
        CHECK(nearest.distance <= (x.transpose() * w).norm() + 1e-12);
      }
    }
  }
}

TEST_CASE("contact: a step ends before two parts touch, and not long before") {
  NodePositions x(4, 3), step = NodePositions::Zero(4, 3);
  x << 0.2, 0.2, 3, 0, 0, 0, 1, 0, 0, 0, 1, 0;
  step(0, 2) = -1;
  const auto bound = [](const ContactPair& pair, const NodePositions& from, const NodePositions& by, double limit,
                        double near = INFINITY) {
    return largest_step(pair, approach(pair, from, by), from, by, limit, near);
  };
  const ContactPair point{{0, 1, 2, 3}, Kind::PointTriangle};
  CHECK(bound(point, x, step, 8) == doctest::Approx(1.5));
  CHECK(bound(point, x, step, 1.4) == 1.4);
  // The pair is 3 apart. With near = 1, half of `near` must remain, so the step may be 2.5 long.
  const double far = bound(point, x, step, 8, 1);
  CHECK(far > 2);
  CHECK(far <= 2.5);
  // The pair's distance of 3 is less than near = 4, so half of the distance must remain.
  CHECK(bound(point, x, step, 8, 4) == doctest::Approx(1.5));
  int too_far = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const NodePositions from = random_places(4, 1, seed), by = random_places(4, 2, seed + 1000);
    for (const Kind kind : {Kind::PointTriangle, Kind::EdgeEdge}) {
      const ContactPair pair{{0, 1, 2, 3}, kind};
      const double before = nearest_points(pair, from).distance;
      for (const double near : {double(INFINITY), 0.3}) {
        const double length = bound(pair, from, by, 1, near), kept = 0.5 * std::min(before, near);
        CHECK(length > 0);
        for (int k = 0; k <= 200; ++k)
          CHECK(nearest_points(pair, from + k / 200.0 * length * by).distance > 0.48 * kept);
        double least = before;
        for (int k = 1; k <= 1000; ++k) least = std::min(least, nearest_points(pair, from + k / 1000.0 * by).distance);
        const bool is = is_too_far(pair, approach(pair, from, by), from, by, near);
        too_far += is;
        if (least < kept) CHECK(is);
        if (is) CHECK(least < kept + approach(pair, from, by).motion / 500);
        else CHECK(length == 1);
      }
    }
  }
  CHECK(too_far > 200);
  CHECK(too_far < 1000);
}

TEST_CASE("contact: the pairs that may come near are those that asking every pair finds, with one thread and two") {
  const TwoBoxes boxes(3);
  const NodePositions step = boxes.upper_by({0, 0, -5}) + random_places(int(boxes.rest.rows()), 0.2, 5);
  std::vector<Key> expected;
  const auto consider = [&](Kind kind, const std::array<int, 4>& node) {
    const ContactPair pair{node, kind};
    double least = 1e9;  // smallest distance, by sampling; every pair nearer than 1 mm must be found
    for (int k = 0; k <= 20; ++k) least = std::min(least, nearest_points(pair, boxes.rest + k / 20.0 * step).distance);
    if (least < 1) expected.push_back(key(pair));
  };
  const auto& F = boxes.F;
  std::vector<std::array<int, 2>> edges;
  for (const auto& f : F.rowwise())
    for (int k = 0; k < 3; ++k)
      if (f[k] < f[(k + 1) % 3]) edges.push_back({f[k], f[(k + 1) % 3]});
  for (const auto& f : F.rowwise())
    for (int v = 0; v < boxes.rest.rows(); ++v)
      if ((F.array() == v).any() && (f.array() != v).all()) consider(Kind::PointTriangle, {v, f[0], f[1], f[2]});
  for (std::size_t a = 0; a < edges.size(); ++a)
    for (std::size_t b = a + 1; b < edges.size(); ++b)
      if (edges[a][0] != edges[b][0] && edges[a][0] != edges[b][1] && edges[a][1] != edges[b][0] &&
          edges[a][1] != edges[b][1])
        consider(Kind::EdgeEdge, {edges[a][0], edges[a][1], edges[b][0], edges[b][1]});
  REQUIRE(expected.size() > 50);

  std::vector<Key> first;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    std::vector<Key> found;
    for (const ContactPair& pair : ContactSurface(F, boxes.rest, boxes.free()).near(boxes.rest, step, 1, {1}))
      found.push_back(key(pair));
    if (threads == 1) first = found;
    CHECK(found == first);
    std::sort(found.begin(), found.end());
    CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
    for (const Key& each : expected) CHECK(std::binary_search(found.begin(), found.end(), each));
  }
}

TEST_CASE("contact: pairs that keep a share of what they are apart at rest may be left out, and no others") {
  const TwoBoxes boxes(3);
  const NodePositions step = boxes.upper_by({0, 0, -2.8}) + random_places(int(boxes.rest.rows()), 0.5, 5);
  const ContactSurface surface(boxes.F, boxes.rest, boxes.free());
  std::vector<Key> some;
  for (const ContactPair& pair : surface.near(boxes.rest, step, 1, {2, 0.5})) some.push_back(key(pair));
  std::sort(some.begin(), some.end());
  const std::vector<ContactPair> all = surface.near(boxes.rest, step, 1, {2});
  CHECK(some.size() < all.size());
  int nearer = 0;
  for (const ContactPair& pair : all) {
    double least = 1e9;
    for (int k = 0; k <= 20; ++k) least = std::min(least, nearest_points(pair, boxes.rest + k / 20.0 * step).distance);
    if (least >= std::min(2.0, 0.5 * nearest_points(pair, boxes.rest).distance)) continue;
    ++nearer;
    CHECK(std::binary_search(some.begin(), some.end(), key(pair)));
  }
  CHECK(nearer > 50);
}

TEST_CASE("contact: what one bone carries is not watched against itself") {
  const TwoBoxes boxes(0.5);
  std::vector<int> rigid(boxes.rest.rows(), 0);
  const NodePositions still = NodePositions::Zero(boxes.rest.rows(), 3);
  CHECK(ContactSurface(boxes.F, boxes.rest, rigid).near(boxes.rest, still, 0, {1}).empty());
  std::fill(rigid.begin() + std::ssize(rigid) / 2, rigid.end(), 1);
  CHECK(!ContactSurface(boxes.F, boxes.rest, rigid).near(boxes.rest, still, 0, {1}).empty());
}

TEST_CASE("contact: of two ways to one place each is watched by itself") {
  TwoBoxes boxes(1);
  // Rounds the positions, so that all sums of positions and steps are exact.
  boxes.rest = (1024 * boxes.rest).array().round() / 1024;
  ContactForm form(boxes.F, boxes.rest, boxes.free());
  // The upper box can reach its end position `above` in two ways: from `beside` through free space, or from `below`
  // through the lower box.
  const NodePositions above = boxes.rest + boxes.upper_by({0, 0, 20}),
                      beside = boxes.rest + boxes.upper_by({50, 0, 20}),
                      below = boxes.rest - boxes.upper_by({0, 0, 20});
  form.build_broad_phase(beside, above - beside, 1);
  CHECK(form.largest_step(beside, above - beside, 1).length == 1);
  form.build_broad_phase(below, above - below, 1);
  CHECK(form.largest_step(below, above - below, 1).length < 1);
}

TEST_CASE("contact: what is known of one way serves the next, and is all that there is to know of it" *
          doctest::test_suite("slow")) {
  const TwoBoxes boxes(1);
  const int count = int(boxes.rest.rows());
  ContactForm form(boxes.F, boxes.rest, boxes.free());
  NodePositions x = boxes.rest;
  std::mt19937 random(5);
  std::uniform_int_distribution<int> any_node(0, count - 1);
  std::int64_t touching = 0;
  for (unsigned k = 0; k < 60; ++k) {
    // The step is large, small, or equal to the previous one but for one node. It starts where the previous step ended,
    // or elsewhere.
    NodePositions step = boxes.upper_by({0, 0,
                                         k % 4 == 0   ? -0.9
                                         : k % 4 == 2 ? 0.7
                                                      : -0.1}) +
                         random_places(count, k % 3 ? 0.05 : 0.5, k);
    if (k % 7 == 0) x += boxes.upper_by({0.4, 0, 0.1});
    double along = 0;
    for (int again = 0; again < 3; ++again, step.row(any_node(random)) *= -2) {
      const double limit = again == 1 ? 0.6 : 1;
      form.build_broad_phase(x, step, limit);
      ContactForm fresh(boxes.F, boxes.rest, boxes.free());
      fresh.build_broad_phase(x, step, limit);
      const double of_form = form.largest_step(x, step, limit).length,
                   of_fresh = fresh.largest_step(x, step, limit).length;
      CHECK((of_form < limit) == (of_fresh < limit));
      CHECK(of_form > 0.5 * of_fresh);
      CHECK(of_form < 2 * of_fresh);
      along = std::min(of_form, of_fresh);
      for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
        const NodePositions there = x + share * along * step;
        form.update_active_pairs(there);
        fresh.update_active_pairs(there);
        CHECK(form.touching() == fresh.touching());
        CHECK(form.value(there) == doctest::Approx(fresh.value(there)).epsilon(1e-12));
        touching += fresh.touching();
      }
      if (again == 2) x += along * step;
    }
  }
  CHECK(touching > 1000);
}

TEST_CASE(
    "contact: nothing pushes at rest, however close skin is, nearer it does, by a force that is the slope of its "
    "energy") {
  const TwoBoxes boxes(0.3);
  ContactForm form(boxes.F, boxes.rest, boxes.free());
  const NodePositions still = NodePositions::Zero(boxes.rest.rows(), 3);
  form.build_broad_phase(boxes.rest, still, 0);
  form.update_active_pairs(boxes.rest);
  CHECK(form.touching() == 0);
  CHECK(form.value(boxes.rest) == 0);

  // Tests nearly parallel edges too: the edges of the boxes are parallel up to `jitter`.
  for (const double jitter : {0.02, 1e-4}) {
    const NodePositions x =
        boxes.rest + boxes.upper_by({0, 0, -0.22}) + random_places(int(boxes.rest.rows()), jitter, 11);
    form.build_broad_phase(x, still, 0);
    form.update_active_pairs(x);
    REQUIRE(form.touching() > 20);
    NodePositions slope = still;
    form.add_gradient(slope);
    CHECK(slope.bottomRows(boxes.rest.rows() / 2).col(2).sum() < 0);  // the energy falls when the upper box moves up
    const NodePositions way = random_places(int(boxes.rest.rows()), 1, 13);
    const double e = 1e-7, difference = (form.value(x + e * way) - form.value(x - e * way)) / (2 * e);
    CHECK(slope.cwiseProduct(way).sum() == doctest::Approx(difference).epsilon(1e-4));
  }
}

TEST_CASE("contact: a step that would press one fold shut yields there, and is taken whole") {
  const TwoBoxes boxes(1);
  FemEnergy energy(boxes.rest, boxes.T, std::vector<TetMaterial>(boxes.T.rows(), {4, 0.3}), 0);
  energy.set_contact(ContactForm(boxes.F, boxes.rest, boxes.free()));
  // One corner of the upper box goes through the lower box, while all nodes move far sideways.
  NodePositions step = boxes.upper_by({0, 0, 0});
  step.col(0).setConstant(20);
  Eigen::Index low = 0;
  (boxes.rest.bottomRows(boxes.rest.rows() / 2) * Eigen::Vector3d(1, 1, 1)).minCoeff(&low);
  step(boxes.rest.rows() / 2 + low, 2) = -1.5;
  const auto bound = energy.largest_step(boxes.rest, step, 1);
  CHECK(bound.length < 0.7);
  CHECK(bound.obstacle == FemEnergy::Obstacle::Contact);
  const NodePositions yielded = energy.limit_step(boxes.rest, step, {});
  CHECK(energy.largest_step(boxes.rest, yielded, 1).length == 1);
  CHECK((yielded.col(0).array() - 20).abs().maxCoeff() < 1e-9);
  // Fixed nodes keep their step.
  std::vector<char> fixed(boxes.rest.rows(), 1);
  CHECK(energy.limit_step(boxes.rest, step, fixed) == step);
}

TEST_CASE("contact: flesh yields at once to a rigid part that is moved against it") {
  const TwoBoxes boxes(0.3);
  const Eigen::Index n = boxes.rest.rows() / 2;
  const NodePositions x = boxes.rest + boxes.upper_by({0, 0, -0.2});
  std::vector<int> upper;
  for (Eigen::Index v = n; v < 2 * n; ++v) upper.push_back(int(v));

  // The predicted change of the force on the lower box is the difference of the forces before and after.
  ContactForm form(boxes.F, boxes.rest, boxes.free());
  const auto forces = [&](const NodePositions& at) {
    NodePositions gradient = NodePositions::Zero(2 * n, 3);
    form.build_broad_phase(at, NodePositions::Zero(2 * n, 3), 0);
    form.update_active_pairs(at);
    form.add_gradient(gradient);
    return gradient;
  };
  const double e = 1e-5;
  const NodePositions down = boxes.upper_by({0, 0, -e}), difference = forces(x + 0.5 * down) - forces(x - 0.5 * down);
  forces(x);
  std::vector<int> unknown(2 * n, -1);
  for (Eigen::Index v = 0; v < n; ++v) unknown[v] = int(v);
  NodePositions push = NodePositions::Zero(2 * n, 3);
  form.add_push(down, unknown, push);
  CHECK(push.bottomRows(n).norm() == 0);
  REQUIRE(push.norm() > 0);
  CHECK((push - difference).topRows(n).norm() < 0.02 * push.norm());

  // The upper box moves down by several times the gap that is left, and the lower box makes room for it.
  FemEnergy energy(boxes.rest, boxes.mesh.T, std::vector<TetMaterial>(boxes.mesh.T.rows(), {4, 0.3}), 0);
  energy.set_contact(ContactForm(boxes.F, boxes.rest, boxes.free()));
  PinForm pins;
  for (Eigen::Index v = 0; v < n; ++v)
    if (boxes.rest(v, 2) == 0) pins.node.push_back(int(v));
  pins.stiffness.setConstant(pins.node.size(), 3, 1e4);
  pins.target = boxes.rest(pins.node, Eigen::all);
  const NodePositions target = x.bottomRows(n).rowwise() + Eigen::RowVector3d(0, 0, -0.4);
  energy.set_constraints(std::move(pins), upper, target);
  energy.build_broad_phase(x);
  NodePositions step;
  double slope = 0;
  REQUIRE(energy.newton_step(x, HessianKind::Projected, step, slope));
  CHECK(step.bottomRows(n).col(2).maxCoeff() == doctest::Approx(-0.4));
  CHECK(energy.largest_step(x, step, 1).length > 0.9);
}
