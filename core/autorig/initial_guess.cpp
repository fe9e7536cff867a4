// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/initial_guess.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>
#include <glm/gtc/quaternion.hpp>

#include "core/autorig/limb_paths.h"

namespace limber {

namespace {

constexpr double kPi = 3.14159265358979323846;

// The main bones of a limb (without fingers or toes), and the bone at whose tail the limb ends.
struct Chain {
  std::vector<int> bones;
  int last = 0;
};

double rest_length(const Armature& rig, int bone, int child) {
  return glm::distance(rig.bones[bone].head, rig.bones[child].head);
}

glm::dmat3 turn_between(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 a = glm::normalize(from), b = glm::normalize(to), across = glm::cross(a, b);
  const double s = glm::length(across);
  if (s < 1e-9) return glm::dmat3(1);
  return glm::mat3_cast(glm::angleAxis(std::atan2(s, glm::dot(a, b)), across / s));
}

void stretch_all(Mannequin& m, double factor) {
  for (double& a : m.along) a = std::log(factor);
  m.across = m.along;
  m.settle();
}

Chain chain_of(const Armature& rig, std::initializer_list<std::string> names, const std::string& last) {
  Chain chain;
  for (const std::string& name : names)
    if (const auto bone = rig.find(name)) chain.bones.push_back(*bone);
  chain.last = rig.find(last).value_or(chain.bones.empty() ? 0 : chain.bones.back());
  return chain;
}

double length_from(const Armature& rig, const Chain& chain, size_t k) {
  double length = glm::distance(rig.bones[chain.bones.back()].head, rig.bones[chain.last].tail);
  for (; k + 1 < chain.bones.size(); ++k) length += rest_length(rig, chain.bones[k], chain.bones[k + 1]);
  return length;
}

// Rotates the bones of a limb so that they follow a path along the limb. The path begins at the limb's free end.
void lay_chain(Mannequin& m, const Chain& chain, const LimbPath& path, double scale) {
  const Armature& rig = m.atlas().rig;
  for (size_t k = 0; k < chain.bones.size(); ++k) {
    const bool is_last = k + 1 == chain.bones.size();
    const double from = scale * length_from(rig, chain, k), to = is_last ? 0 : scale * length_from(rig, chain, k + 1);
    const glm::dvec3 way = path.at(to) - path.at(from);
    const glm::dvec3 next = is_last ? m.carried(chain.last, rig.bones[chain.last].tail) : m.joint(chain.bones[k + 1]);
    const glm::dvec3 now = next - m.joint(chain.bones[k]);
    if (glm::length(way) > 1e-6 && glm::length(now) > 1e-6) m.turn_branch(chain.bones[k], turn_between(now, way));
  }
}

glm::dmat3 frame(const glm::dvec3& left, const glm::dvec3& up) {
  const glm::dvec3 z = glm::normalize(up), x = glm::normalize(left - z * glm::dot(left, z));
  return glm::dmat3(x, glm::cross(z, x), z);
}

void put_body(Mannequin& m, const glm::dmat3& axes, double scale, const glm::dvec3& hips) {
  for (glm::dmat3& turn : m.turn) turn = axes;
  m.root = hips;
  stretch_all(m, scale);
}

Chain chain_for(AtlasKind kind, const Armature& rig) {
  if (kind == AtlasKind::Leg) return chain_of(rig, {"Thigh", "Shank", "Foot"}, "Toes");
  if (kind == AtlasKind::Hand) return chain_of(rig, {"Hand"}, "MiddleDistal");
  return chain_of(rig, {"UpperArm", "Forearm", "Hand"}, "MiddleDistal");
}

// Returns the corners of the bounding box of the cells that are filled with tissue; world, mm.
std::pair<glm::dvec3, glm::dvec3> extent_of(const Occupancy& body) {
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
  const AffineTransform to_world = world_from_voxel(body.grid);
  for (int z = 0; z < body.grid.size.z; ++z)
    for (int y = 0; y < body.grid.size.y; ++y)
      for (int x = 0; x < body.grid.size.x; ++x)
        if (body.filled({x, y, z})) {
          const glm::dvec3 place = to_world * glm::dvec3(x, y, z);
          low = glm::min(low, place), high = glm::max(high, place);
        }
  return {low, high};
}

}  // namespace

namespace {

// Sizes of the whole-body atlas, mm: heights of the crown and of the hips above the soles, and distance from the body's
// middle to a hand.
constexpr double kStature = 1748, kHips = 925, kHalfSpan = 610;

bool is_cut(const std::vector<TissueCut>& cuts, const glm::dvec3& way) {
  return std::any_of(cuts.begin(), cuts.end(), [&](const TissueCut& cut) { return glm::dot(cut.normal, way) > 0.9; });
}

// Returns `steps` evenly spaced numbers from `from` to `to`; for one step, only `from`.
std::vector<double> ladder(double from, double to, int steps) {
  std::vector<double> rungs;
  for (int k = 0; k < steps; ++k) rungs.push_back(steps > 1 ? from + (to - from) * k / (steps - 1) : from);
  return rungs;
}

// Adds guesses for a body that is cut off and stands upright in LPS axes. Each guess places a whole body so that the
// part between the cuts fills the tissue, in several sizes, heights and arm poses that the cuts allow.
void add_cut_bodies(const BodyAtlas& atlas, const glm::dvec3& low, const glm::dvec3& high,
                    const std::vector<TissueCut>& cuts, std::vector<Mannequin>& starts) {
  const bool no_feet = is_cut(cuts, {0, 0, -1}), no_head = is_cut(cuts, {0, 0, 1});
  const bool no_right = is_cut(cuts, {-1, 0, 0}), no_left = is_cut(cuts, {1, 0, 0});
  const double height = high.z - low.z;
  std::vector<double> scales{1, 0.8, 0.64};
  if (!no_feet && !no_head) scales = {height / kStature};
  for (double scale : scales) {
    const double whole = scale * kStature;
    std::vector<double> soles{low.z};
    if (no_feet) soles = {high.z - whole};
    if (no_feet && no_head)
      soles =
          ladder(low.z, high.z - whole, std::max(1, static_cast<int>(std::ceil((whole - height) / (0.07 * whole)))));
    std::vector<double> middles{(low.x + high.x) / 2};
    if (no_left && !no_right) middles = {high.x, low.x + scale * kHalfSpan};
    if (no_right && !no_left) middles = {low.x, high.x - scale * kHalfSpan};
    for (double sole : soles)
      for (double middle : middles)
        for (double raised : {0.0, -0.6, 0.8}) {
          Mannequin m(atlas);
          put_body(m, glm::dmat3(1), scale, {middle, (low.y + high.y) / 2, sole + scale * kHips});
          for (const auto& [name, side] : {std::pair("LeftUpperArm", -1.0), std::pair("RightUpperArm", 1.0)})
            if (const auto arm = atlas.rig.find(name))
              m.turn_branch(*arm, glm::mat3_cast(glm::angleAxis(side * raised, glm::dvec3(0, 1, 0))));
          starts.push_back(m);
        }
  }
}

}  // namespace

std::vector<Mannequin> body_starts(const BodyAtlas& atlas, const Occupancy& body, const std::vector<TissueCut>& cuts) {
  std::vector<Mannequin> starts;
  const auto [low, high] = extent_of(body);
  if (!cuts.empty()) add_cut_bodies(atlas, low, high, cuts, starts);
  const auto paths = limb_paths(body, PathCentre::Thickest);
  const Armature& rig = atlas.rig;
  {
    Mannequin upright(atlas);
    const double scale = (high.z - low.z) / kStature;
    put_body(upright, glm::dmat3(1), scale,
             glm::dvec3((low.x + high.x) / 2, (low.y + high.y) / 2, low.z + kHips * scale));
    starts.push_back(upright);
  }
  if (paths.size() < 3) return starts;

  // Of the five tissue ends, the head is the one nearest to the body's centre. The feet are the two lowest ends, where
  // up points from the centre to the head.
  std::vector<LimbPath> ends(paths.begin(), paths.begin() + std::min<size_t>(paths.size(), 5));
  const glm::dvec3 centre = ends[0].points.back();
  const auto head = std::min_element(ends.begin(), ends.end(), [](auto& a, auto& b) { return a.length < b.length; });
  const LimbPath crown = *head;
  ends.erase(head);
  const glm::dvec3 upwards = crown.points.front() - centre;
  std::sort(ends.begin(), ends.end(), [&](auto& a, auto& b) {
    return glm::dot(a.points.front(), upwards) < glm::dot(b.points.front(), upwards);
  });
  const LimbPath feet[2] = {ends[0], ends[1]};
  const double whole = crown.length + (feet[0].length + feet[1].length) / 2, scale = whole / 1960;
  // Length of a leg from the toes to the hip (foot, shank and thigh), mm.
  const double leg = scale * 1040;
  const glm::dvec3 hips = (feet[0].at(leg) + feet[1].at(leg)) / 2.0;
  const glm::dvec3 up = crown.points.front() - hips, across = feet[0].at(leg * 0.75) - feet[1].at(leg * 0.75);
  if (glm::length(glm::cross(up, across)) < 1e-6) return starts;
  for (int facing = 0; facing < 2; ++facing) {
    const glm::dmat3 axes = frame(facing ? -across : across, up);
    Mannequin m(atlas);
    put_body(m, axes, scale, hips);
    lay_chain(m, chain_of(rig, {"LeftThigh", "LeftShank", "LeftFoot"}, "LeftToes"), feet[facing], scale);
    lay_chain(m, chain_of(rig, {"RightThigh", "RightShank", "RightFoot"}, "RightToes"), feet[1 - facing], scale);
    for (size_t k = 2; k < ends.size(); ++k) {
      // An arm is left or right by the side on which it leaves the trunk.
      const glm::dvec3 shoulder = ends[k].at(scale * 700);
      const bool left = glm::dot(axes[0], shoulder - hips) > 0;
      const std::string side = left ? "Left" : "Right";
      lay_chain(m, chain_of(rig, {side + "UpperArm", side + "Forearm", side + "Hand"}, side + "MiddleDistal"), ends[k],
                scale);
    }
    starts.push_back(m);
  }
  return starts;
}

namespace {

// Lengthens a path by `by` mm along a straight line: at its first point if `before` is true, else at its last point.
void extend(LimbPath& path, double by, bool before) {
  if (path.points.size() < 2) return;
  constexpr size_t kSteps = 8;  // number of path steps over which the direction at the path's end is measured
  if (before) std::reverse(path.points.begin(), path.points.end());
  const glm::dvec3 last = path.points.back(),
                   out = last - path.points[path.points.size() - 1 - std::min(path.points.size() - 1, kSteps)];
  for (double along = path.step; along <= by && glm::length(out) > 0; along += path.step)
    path.points.push_back(last + along * glm::normalize(out));
  path.length = path.step * double(path.points.size() - 1);
  if (before) std::reverse(path.points.begin(), path.points.end());
}

}  // namespace

std::vector<Mannequin> limb_starts(const BodyAtlas& atlas, const Occupancy& body, AtlasKind kind,
                                   const std::vector<TissueCut>& cuts) {
  // Distance by which flesh reaches beyond the joint at which a limb begins, mm.
  constexpr double beyond_root = 40;
  const Chain chain = chain_for(kind, atlas.rig);
  std::vector<Mannequin> starts;
  auto paths = limb_paths(body, PathCentre::FarthestEnd);
  if (paths.empty() || chain.bones.empty()) return starts;
  LimbPath path = paths[0];
  const Armature& rig = atlas.rig;
  const double length = beyond_root + length_from(rig, chain, 0);
  // An assumption about a limb's size. Three are tried: the limb is as long as the tissue; it has an adult's size and
  // its tip is cut off; it has an adult's size and its root is cut off.
  struct Lie {
    double scale;
    bool no_tip;
  };
  std::vector<Lie> lies{{path.length / length, false}};
  if (!cuts.empty() && path.length < 0.9 * length) lies.insert(lies.end(), {{1, true}, {1, false}});
  for (int way = 0; way < 2; ++way) {
    for (const auto& [scale, no_tip] : lies) {
      LimbPath whole = path;
      extend(whole, scale * length - path.length, no_tip);
      for (int roll = 0; roll < 8; ++roll) {
        Mannequin m(atlas);
        const double root = scale * (length - beyond_root);
        const glm::dvec3 start = whole.at(root), on = whole.at(0.6 * root) - start;
        if (!(glm::length(on) > 0)) break;
        const glm::dvec3 first = rig.bones[chain.bones[0]].head,
                         rest = (chain.bones.size() > 1 ? rig.bones[chain.bones[1]].head : rig.bones[chain.last].tail) -
                                first;
        const glm::dmat3 lie = turn_between(rest, on);
        const glm::dmat3 about = glm::mat3_cast(glm::angleAxis(roll * kPi / 4, glm::normalize(on)));
        put_body(m, about * lie, scale, start);
        lay_chain(m, chain, whole, scale);
        starts.push_back(m);
      }
    }
    std::reverse(path.points.begin(), path.points.end());
  }
  return starts;
}

namespace {

struct Extent {
  glm::dvec3 middle{0}, low{1e300}, high{-1e300};
  glm::dmat3 axes{1};  // principal axes as columns, the longest first; right-handed
};

Extent extent_of(const std::vector<glm::dvec3>& points) {
  Extent extent;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const glm::dvec3& p : points)
    extent.middle += p / double(points.size()), extent.low = glm::min(extent.low, p),
                                                extent.high = glm::max(extent.high, p);
  for (const glm::dvec3& p : points) {
    const Eigen::Vector3d d(p.x - extent.middle.x, p.y - extent.middle.y, p.z - extent.middle.z);
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) extent.axes[k][i] = solver.eigenvectors()(i, 2 - k);
  if (glm::determinant(extent.axes) < 0) extent.axes[2] = -extent.axes[2];
  return extent;
}

// Returns the 24 rotations by right angles, which map the coordinate axes to each other.
std::vector<glm::dmat3> axis_turns() {
  std::vector<glm::dmat3> turns;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (double sx : {1.0, -1.0})
        for (double sy : {1.0, -1.0}) {
          if (x == y) continue;
          glm::dvec3 first(0), second(0);
          first[x] = sx, second[y] = sy;
          turns.push_back(glm::dmat3(first, second, glm::cross(first, second)));
        }
  return turns;
}

}  // namespace

std::vector<Mannequin> turned_starts(const BodyAtlas& atlas, const Occupancy& body) {
  std::vector<glm::dvec3> tissue, skin;
  const AffineTransform to_world = world_from_voxel(body.grid);
  for (int z = 0; z < body.grid.size.z; ++z)
    for (int y = 0; y < body.grid.size.y; ++y)
      for (int x = 0; x < body.grid.size.x; ++x)
        if (body.filled({x, y, z})) tissue.push_back(to_world * glm::dvec3(x, y, z));
  for (const AtlasPoint& point : atlas.skin) skin.push_back(point.place);
  std::vector<Mannequin> starts;
  if (tissue.empty() || skin.empty()) return starts;
  // Factor on the prior that keeps the lengths of bones in proportion. A round limb does not show where it bends, so
  // its surface does not give these lengths.
  constexpr double kAlike = 4;
  const Extent there = extent_of(tissue), here = extent_of(skin);
  std::vector<glm::dmat3> turns = axis_turns();
  for (const glm::dmat3& turn : axis_turns()) turns.push_back(there.axes * turn * glm::transpose(here.axes));
  for (const glm::dmat3& turn : turns) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::dvec3& p : skin) low = glm::min(low, turn * p), high = glm::max(high, turn * p);
    const double scale = glm::distance(there.low, there.high) / glm::distance(low, high);
    Mannequin m(atlas);
    std::fill(m.along.begin(), m.along.end(), std::log(scale));
    m.across = m.along;
    m.alike = kAlike;
    for (glm::dmat3& own : m.turn) own = turn;
    m.root = (there.low + there.high) / 2.0 + scale * (turn * atlas.rig.bones[0].head - (low + high) / 2.0);
    m.settle();
    starts.push_back(std::move(m));
  }
  return starts;
}

}  // namespace limber
