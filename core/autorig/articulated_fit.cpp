// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/articulated_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/quaternion.hpp>

#include "core/base/parallel.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

// Weight of the surfaces relative to the priors. However many point pairs there are, together they weigh as much as
// kPairs pairs whose distances have a standard deviation of kPairSpread mm.
constexpr double kPairs = 1000, kPairSpread = 5;
// Standard deviations of the prior on bone sizes. A log stretch is the logarithm of a bone's scale factor. The prior
// limits its difference between neighbouring bones, and between the directions along and across one bone.
constexpr double kNeighbourStretch = 0.07, kRoundStretch = 0.12;
constexpr double kHingeAside = 0.1;  // prior standard deviation of a hinge joint's rotation off its axis, radians
// Prior standard deviation of a hand's twist relative to the elbow end of its forearm, radians.
constexpr double kWringing = 1.5;
// Larger changes of a bone in one Gauss-Newton step are cut to these: rotation (radians) and log stretch.
constexpr double kLargestTurn = 0.35, kLargestStretch = 0.15;

std::string without_side(const std::string& name) {
  for (const char* side : {"Left", "Right"})
    if (name.starts_with(side)) return name.substr(std::string(side).size());
  for (const char* side : {".L", ".R"})
    if (name.ends_with(side)) return name.substr(0, name.size() - 2);
  return name;
}

// Returns the prior standard deviation of a joint's rotation away from the atlas's rest pose, radians.
double spread_of_turn(const std::string& bone) {
  const std::string name = without_side(bone);
  if (name == "Spine" || name == "Chest") return 0.15;
  if (name == "Clavicle") return 0.15;
  if (name == "Neck" || name == "Head") return 0.25;
  if (name == "Jaw") return 0.1;
  if (name == "Hand" || name == "Foot") return 0.4;
  if (name == "Toes") return 0.2;
  if (name == "UpperArm" || name == "Thigh" || name == "Forearm" || name == "Shank") return 0.9;
  if (name.ends_with("Metacarpal")) return name == "ThumbMetacarpal" ? 0.3 : 0.08;
  return 0.3;
}

glm::dvec3 rotation_vector(const glm::dmat3& rotation) {
  glm::dquat q = glm::normalize(glm::quat_cast(rotation));
  if (q.w < 0) q = -q;
  const glm::dvec3 v(q.x, q.y, q.z);
  const double s = glm::length(v);
  return s < 1e-12 ? 2.0 * v : v * (2 * std::atan2(s, q.w) / s);
}

glm::dmat3 orthonormal(const glm::dmat3& m) { return glm::mat3_cast(glm::normalize(glm::quat_cast(m))); }

}  // namespace

Mannequin::Mannequin(const BodyAtlas& atlas) : atlas_(&atlas) {
  std::map<std::string, int> groups;
  for (const Bone& bone : atlas.rig.bones) {
    group_.push_back(groups.insert({without_side(bone.name), static_cast<int>(groups.size())}).first->second);
    const glm::dvec3 along = bone.tail - bone.head;
    axis_.push_back(glm::length(along) > 0 ? glm::normalize(along) : glm::dvec3(0, 0, 1));
  }
  wrung_by_.assign(atlas.rig.bones.size(), -1);
  wrung_.assign(atlas.rig.bones.size(), 0);
  for (int b = 0; b < std::ssize(atlas.rig.bones); ++b)
    if (const int parent = atlas.rig.bones[b].parent; parent >= 0 && without_side(atlas.rig.bones[b].name) == "Hand")
      wrung_by_[parent] = b;
  root = atlas.rig.bones[0].head;
  turn.assign(atlas.rig.bones.size(), glm::dmat3(1));
  along.assign(groups.size(), 0);
  across = along;
  settle();
}

void Mannequin::settle() {
  joint_.resize(turn.size());
  moved_.resize(turn.size());
  for (int b = 0; b < bone_count(); ++b) {
    const double s = std::exp(along[group_[b]]), t = std::exp(across[group_[b]]);
    moved_[b] = turn[b] * (t * glm::dmat3(1) + (s - t) * glm::outerProduct(axis_[b], axis_[b]));
    const int parent = atlas_->rig.bones[b].parent;
    joint_[b] = parent < 0
                    ? root
                    : joint_[parent] + moved_[parent] * (atlas_->rig.bones[b].head - atlas_->rig.bones[parent].head);
    if (const int by = wrung_by_[b]; by >= 0)
      wrung_[b] = swing_twist(glm::quat_cast(glm::transpose(turn[b]) * turn[by]), axis_[b]).twist;
  }
}

double Mannequin::wrung_share(int bone, const glm::dvec3& place) const {
  const Bone& b = atlas_->rig.bones[bone];
  return std::clamp(glm::dot(place - b.head, axis_[bone]) / glm::distance(b.head, b.tail), 0.0, 1.0);
}

glm::dmat3 Mannequin::turn_at(int bone, const glm::dvec3& place) const {
  if (wrung_by_[bone] < 0) return turn[bone];
  return turn[bone] * glm::mat3_cast(glm::angleAxis(wrung_[bone] * wrung_share(bone, place), axis_[bone]));
}

glm::dvec3 Mannequin::carried(int bone, const glm::dvec3& place) const {
  glm::dvec3 from_head = place - atlas_->rig.bones[bone].head;
  if (wrung_by_[bone] >= 0)
    from_head = glm::angleAxis(wrung_[bone] * wrung_share(bone, place), axis_[bone]) * from_head;
  return joint_[bone] + moved_[bone] * from_head;
}

void Mannequin::turn_branch(int bone, const glm::dmat3& by) {
  std::vector<std::uint8_t> below(bone_count(), 0);
  for (int b = bone; b < bone_count(); ++b) {
    const int parent = atlas_->rig.bones[b].parent;
    below[b] = b == bone || (parent >= 0 && below[parent]);
    if (below[b]) turn[b] = by * turn[b];
  }
  settle();
}

namespace {

struct Pair {
  int bone;
  glm::dvec3 rest, place;   // position of the atlas point at rest, and in the present pose, mm
  glm::dvec3 goal, normal;  // the matched point of the volume's surface, and its normal
  double weight;
};

// The point pairs of one stage of the fit. Each atlas point (`rest`: at rest, `here`: in the present pose) is paired
// with its nearest surface point, and each surface point in `goals` with its nearest atlas point.
struct Asked {
  Asked(const Mannequin& mannequin, const std::vector<AtlasPoint>& points, const FitSurface& surface,
        const FitStage& stage) {
    for (size_t i = 0; i < points.size(); i += stage.stride) {
      const AtlasPoint& point = points[i];
      if (!stage.points.empty() && !stage.points[point.bone]) continue;
      const glm::dvec3 place = mannequin.carried(point.bone, point.place);
      if (beyond(surface.cuts, place) > 0) continue;
      rest.push_back(point);
      here.push_back({place, mannequin.turn_at(point.bone, point.place) * point.normal});
    }
    for (size_t i = 0; i < surface.sparse.size(); i += stage.stride)
      if (stage.reach <= 0 || glm::distance(surface.sparse[i].place, stage.around) < stage.reach)
        goals.push_back(surface.sparse[i]);
  }
  std::vector<AtlasPoint> rest;
  std::vector<SurfacePoint> here, goals;
};

double robust(double distance, double width) {
  const double q = width * width / (width * width + distance * distance);
  return q * q;
}

void add_pairs(const Mannequin& mannequin, const std::vector<AtlasPoint>& points, const FitSurface& surface,
               double width, double share, const FitStage& stage, std::vector<Pair>& pairs) {
  const double reach = 3 * width;
  const Asked asked(mannequin, points, surface, stage);
  const auto pair_of = [&](std::int64_t i, const SurfacePoint& goal) {
    return Pair{asked.rest[i].bone, asked.rest[i].place, asked.here[i].place,
                goal.place,         goal.normal,         robust(glm::distance(asked.here[i].place, goal.place), width)};
  };
  const auto gather = [&](std::int64_t count, const auto& find) {
    std::vector<Pair> found(count, Pair{-1, {}, {}, {}, {}, 0});
    parallel_for(count, 256, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) find(i, found[i]);
    });
    const double each = share / 2 / std::max<double>(1, static_cast<double>(count));
    for (Pair& pair : found)
      if (pair.bone >= 0) {
        pair.weight *= each;
        pairs.push_back(pair);
      }
  };
  gather(std::ssize(asked.here), [&](std::int64_t i, Pair& pair) {
    const int n = surface.tree.nearest(asked.here[i].place, asked.here[i].normal, reach);
    if (n >= 0) pair = pair_of(i, surface.points[n]);
  });
  const PointTree tree(asked.here);
  gather(std::ssize(asked.goals), [&](std::int64_t i, Pair& pair) {
    const int n = tree.nearest(asked.goals[i].place, asked.goals[i].normal, reach);
    if (n >= 0) pair = pair_of(n, asked.goals[i]);
  });
}

// Builds and solves the normal equations of one Gauss-Newton step, summed over all matched pairs of points and the
// priors.
class Step {
 public:
  Step(const Mannequin& mannequin, const FitStage& stage) : m_(mannequin) {
    const int bones = m_.bone_count();
    turn_at_.assign(bones, -1);
    sums_.resize(bones);
    count_ = 3;
    for (int b = 0; b < bones; ++b)
      if (stage.turns.empty() || stage.turns[b]) turn_at_[b] = count_, count_ += 3;
    stretch_at_ = stage.stretches ? count_ : -1;
    if (stage.stretches) count_ += 2 * m_.group_count();
    H_ = Eigen::MatrixXd::Zero(count_, count_);
    g_ = Eigen::VectorXd::Zero(count_);
  }

  void add(const Pair& pair) {
    // The component of a pair's distance along the surface normal has full weight. The component along the surface has
    // the small weight kAlong, so that points can slide along the surface, but not without limit.
    constexpr double kAlong = 0.15;
    add(pair, kAlong * glm::dmat3(1) + (1 - kAlong) * glm::outerProduct(pair.normal, pair.normal));
  }

  // Adds a pair whose distance has the same weight in all directions.
  void add_free(const Pair& pair) { add(pair, glm::dmat3(1)); }

  // Adds the priors on the rotations and stretches of bones.
  //   share  factor on the weights of all these priors
  void add_likings(double share = 1) {
    const Armature& rig = m_.atlas().rig;
    for (int b = 0; b < m_.bone_count(); ++b) {
      const int parent = rig.bones[b].parent;
      if (turn_at_[b] < 0 || parent < 0) continue;
      const glm::dvec3 r = rotation_vector(glm::transpose(m_.turn[parent]) * m_.turn[b]);
      const double spread = spread_of_turn(rig.bones[b].name), w = share / (spread * spread);
      // Adds a prior against a rotation about `direction`, a unit vector in the parent's rest frame.
      const auto like = [&](const glm::dvec3& direction, double weight) {
        const glm::dvec3 row = m_.turn[parent] * direction;
        for (int i = 0; i < 3; ++i) {
          g_[turn_at_[b] + i] += weight * row[i] * glm::dot(r, direction);
          for (int j = 0; j < 3; ++j) H_(turn_at_[b] + i, turn_at_[b] + j) += weight * row[i] * row[j];
        }
      };
      for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 direction(0);
        direction[axis] = 1;
        like(direction, w);
      }
      // Prior of a hinge joint: the joint rotates about its axis only, and not below the minimum of its limits.
      if (const JointLimits& limits = rig.bones[b].limits; limits.type == JointLimits::Type::Hinge) {
        const glm::dvec3 side = glm::normalize(
            glm::cross(limits.axis, std::abs(limits.axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        const double stiff = share / (kHingeAside * kHingeAside);
        like(side, stiff);
        like(glm::cross(limits.axis, side), stiff);
        const double beyond = limits.minimum - glm::dot(r, limits.axis);
        if (beyond > 0) {
          const glm::dvec3 row = m_.turn[parent] * limits.axis;
          for (int i = 0; i < 3; ++i) {
            g_[turn_at_[b] + i] -= stiff * row[i] * beyond;
            for (int j = 0; j < 3; ++j) H_(turn_at_[b] + i, turn_at_[b] + j) += stiff * row[i] * row[j];
          }
        }
      }
      if (m_.wrung_by(parent) == b) like(m_.rest_axis(parent), share / (kWringing * kWringing) - w);
    }
    if (stretch_at_ < 0) return;
    std::vector<std::uint8_t> done(m_.group_count(), 0);
    for (int b = 0; b < m_.bone_count(); ++b) {
      const int group = m_.group_of(b), parent = rig.bones[b].parent;
      if (done[group]++) continue;
      like_equal(2 * group, 2 * group + 1, m_.along[group] - m_.across[group], kRoundStretch / std::sqrt(share));
      if (parent < 0) continue;
      const int above = m_.group_of(parent);
      if (above == group) continue;
      like_equal(2 * group, 2 * above, m_.along[group] - m_.along[above],
                 kNeighbourStretch / (m_.alike * std::sqrt(share)));
      like_equal(2 * group + 1, 2 * above + 1, m_.across[group] - m_.across[above],
                 kNeighbourStretch / std::sqrt(share));
    }
  }

  // Solves the equations and returns the mannequin after the step.
  Mannequin taken() {
    gather();
    for (int i = 0; i < count_; ++i) H_(i, i) += 1e-6 + 1e-4 * H_(i, i);
    const Eigen::VectorXd x = H_.selfadjointView<Eigen::Lower>().ldlt().solve(-g_);
    Mannequin next = m_;
    if (!x.allFinite()) return next;
    next.root += glm::dvec3(x[0], x[1], x[2]);
    const Armature& rig = m_.atlas().rig;
    std::vector<glm::dmat3> by(m_.bone_count(), glm::dmat3(1));
    for (int b = 0; b < m_.bone_count(); ++b) {
      if (rig.bones[b].parent >= 0) by[b] = by[rig.bones[b].parent];
      if (turn_at_[b] >= 0) {
        glm::dvec3 v(x[turn_at_[b]], x[turn_at_[b] + 1], x[turn_at_[b] + 2]);
        if (const double angle = glm::length(v); angle > kLargestTurn) v *= kLargestTurn / angle;
        by[b] = glm::mat3_cast(exponential(v)) * by[b];
      }
      next.turn[b] = orthonormal(by[b] * m_.turn[b]);
    }
    if (stretch_at_ >= 0)
      for (int g = 0; g < m_.group_count(); ++g) {
        next.along[g] += std::clamp(x[stretch_at_ + 2 * g], -kLargestStretch, kLargestStretch);
        next.across[g] += std::clamp(x[stretch_at_ + 2 * g + 1], -kLargestStretch, kLargestStretch);
      }
    next.settle();
    return next;
  }

 private:
  // The degrees of freedom that move the points of one bone, each with its first column in the Jacobian: translation of
  // the bone's joint (0), rotation (3), stretch along and across the bone (6, 7), and the twist that a forearm takes
  // from its hand (8).
  static constexpr int kWays = 9;
  using Ways = Eigen::Matrix<double, 3, kWays>;
  struct BoneSum {
    Eigen::Matrix<double, kWays, kWays> H = Eigen::Matrix<double, kWays, kWays>::Zero();
    Eigen::Matrix<double, kWays, 1> g = Eigen::Matrix<double, kWays, 1>::Zero();
    bool has_pairs = false;
  };

  static void put(Ways& J, int column, const glm::dvec3& v) { J.col(column) << v.x, v.y, v.z; }

  void add(const Pair& pair, const glm::dmat3& metric) {
    const int b = pair.bone;
    const glm::dvec3 arm = pair.place - m_.joint(b), axis = m_.rest_axis(b);
    const glm::dvec3 along = m_.direction(b, axis * glm::dot(axis, pair.rest - m_.atlas().rig.bones[b].head));
    Ways J = Ways::Zero();
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 unit(0);
      unit[i] = 1;
      put(J, i, unit);
      put(J, 3 + i, glm::cross(unit, arm));
    }
    put(J, 6, along);
    put(J, 7, arm - along);
    if (m_.wrung_by(b) >= 0) put(J, 8, m_.wrung_share(b, pair.rest) * glm::cross(m_.turn[b] * axis, arm));
    Eigen::Matrix3d W;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) W(i, j) = pair.weight * metric[i][j];
    const glm::dvec3 r = pair.place - pair.goal;
    const Eigen::Matrix<double, kWays, 3> JW = J.transpose() * W;
    sums_[b].H += JW * J;
    sums_[b].g += JW * Eigen::Vector3d(r.x, r.y, r.z);
    sums_[b].has_pairs = true;
  }

  // Adds each bone's sums over its point pairs to the normal equations, by the chain rule: a bone's points depend on
  // the variables of the bone and of all its ancestors.
  void gather() {
    const Armature& rig = m_.atlas().rig;
    for (int b = 0; b < m_.bone_count(); ++b) {
      if (!sums_[b].has_pairs) continue;
      columns_.clear();
      for (int axis = 0; axis < 3; ++axis) column(axis)[axis] = 1;
      for (int a = b, below = -1; a >= 0; below = a, a = rig.bones[a].parent) {
        const glm::dvec3 arm = m_.joint(b) - m_.joint(a);
        for (int axis = 0; axis < 3 && turn_at_[a] >= 0; ++axis) {
          glm::dvec3 unit(0);
          unit[axis] = 1;
          auto& turned = column(turn_at_[a] + axis);
          add_shift(turned, glm::cross(unit, arm));
          turned[3 + axis] = 1;
        }
        if (stretch_at_ < 0) continue;
        const int at = stretch_at_ + 2 * m_.group_of(a);
        if (below < 0) {
          column(at)[6] = 1, column(at + 1)[7] = 1;
        } else {
          const glm::dvec3 axis = m_.rest_axis(a), l = rig.bones[below].head - rig.bones[a].head,
                           up = axis * glm::dot(axis, l);
          add_shift(column(at), m_.direction(a, up));
          add_shift(column(at + 1), m_.direction(a, l - up));
        }
      }
      if (const int by = m_.wrung_by(b); by >= 0 && turn_at_[by] >= 0)
        for (int axis = 0; axis < 3; ++axis) column(turn_at_[by] + axis)[8] = (m_.turn[b] * m_.rest_axis(b))[axis];
      for (const auto& [i, u] : columns_) {
        g_[i] += u.dot(sums_[b].g);
        const Eigen::Matrix<double, kWays, 1> Hu = sums_[b].H * u;
        for (const auto& [j, v] : columns_)
          if (j <= i) H_(i, j) += Hu.dot(v);
      }
    }
  }

  using Column = Eigen::Matrix<double, kWays, 1>;
  static void add_shift(Column& column, const glm::dvec3& by) { column.head<3>() += Eigen::Vector3d(by.x, by.y, by.z); }
  Column& column(int i) { return columns_.insert({i, Column::Zero()}).first->second; }

  void like_equal(int a, int b, double difference, double spread) {
    const double w = 1 / (spread * spread);
    a += stretch_at_, b += stretch_at_;
    g_[a] += w * difference, g_[b] -= w * difference;
    H_(a, a) += w, H_(b, b) += w;
    H_(std::max(a, b), std::min(a, b)) -= w;
  }

  const Mannequin& m_;
  int count_ = 0, stretch_at_ = -1;
  std::vector<int> turn_at_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  std::vector<BoneSum> sums_;      // sums over the point pairs of each bone
  std::map<int, Column> columns_;  // derivatives of the current bone's degrees of freedom by the fit's variables
};

}  // namespace

void fit(Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, const FitStage& stage) {
  const BodyAtlas& atlas = mannequin.atlas();
  const double data = kPairs / (kPairSpread * kPairSpread);
  for (int k = 0; k < stage.iterations; ++k) {
    const double t = stage.iterations > 1 ? double(k) / (stage.iterations - 1) : 1;
    const double width = stage.wide * std::pow(stage.narrow / stage.wide, t);
    std::vector<Pair> pairs;
    const double to_bone = !bone ? 0 : !skin ? 1 : stage.bone_share;
    if (skin) add_pairs(mannequin, atlas.skin, *skin, width, data * (1 - to_bone), stage, pairs);
    if (bone) add_pairs(mannequin, atlas.bone, *bone, width, data * to_bone, stage, pairs);
    Step step(mannequin, stage);
    for (const Pair& pair : pairs) step.add(pair);
    step.add_likings();
    mannequin = step.taken();
  }
}

namespace {

// A line segment of a rig: a bone, or the link from the pelvis's head to a thigh's head. The link is needed because a
// thigh does not begin at the pelvis's tail.
struct Segment {
  int bone;
  glm::dvec3 a, b;  // end points at rest, mm
};

std::vector<Segment> segments_of(const Armature& rig, const std::vector<std::uint8_t>& free) {
  std::vector<Segment> segments;
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (!free.empty() && !free[b]) continue;
    const Bone& bone = rig.bones[b];
    segments.push_back({b, bone.head, bone.tail});
    if (bone.parent >= 0 && without_side(bone.name) == "Thigh")
      segments.push_back({bone.parent, rig.bones[bone.parent].head, bone.head});
  }
  return segments;
}

// Returns a byte per bone: 1 for a bone that can be fitted to the axis of a rod (a round bar that represents a bone in
// the volume). Hands, fingers and the jaw get 0, because hands are too short and have too many bones.
std::vector<std::uint8_t> without_hands(const Armature& rig) {
  std::vector<std::uint8_t> kept;
  for (const Bone& bone : rig.bones) {
    const bool below = bone.parent >= 0 && (!kept[bone.parent] || without_side(rig.bones[bone.parent].name) == "Hand");
    kept.push_back(!below && without_side(bone.name) != "Hand" && bone.name != "Jaw");
  }
  return kept;
}

double nearest_on(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
  const glm::dvec3 along = b - a;
  const double length = glm::dot(along, along);
  return length > 0 ? std::clamp(glm::dot(p - a, along) / length, 0.0, 1.0) : 0;
}

}  // namespace

void fit_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& all_cells, const FitSurface& skin,
              const FitStage& stage) {
  const Armature& rig = mannequin.atlas().rig;
  std::vector<glm::dvec3> cells;
  for (const glm::dvec3& cell : all_cells) {
    const bool in_hand = std::any_of(rig.bones.begin(), rig.bones.end(), [&](const Bone& bone) {
      if (without_side(bone.name) != "Hand" || bone.parent < 0) return false;
      const int hand = static_cast<int>(&bone - rig.bones.data());
      const glm::dvec3 wrist = mannequin.joint(hand), along = glm::normalize(wrist - mannequin.joint(bone.parent));
      const double past = glm::dot(cell - wrist, along), forearm = glm::distance(wrist, mannequin.joint(bone.parent));
      return past > -0.05 * forearm && glm::distance(cell, wrist) < forearm;
    });
    if (!in_hand) cells.push_back(cell);
  }
  const std::vector<Segment> segments = segments_of(rig, without_hands(rig));
  const double all = kPairs / (kPairSpread * kPairSpread),
               data = all * stage.bone_share / std::max<double>(1, static_cast<double>(cells.size()));
  for (int k = 0; k < stage.iterations; ++k) {
    const double t = stage.iterations > 1 ? double(k) / (stage.iterations - 1) : 1;
    const double width = stage.wide * std::pow(stage.narrow / stage.wide, t);
    std::vector<std::pair<glm::dvec3, glm::dvec3>> lines;
    for (const Segment& s : segments) lines.push_back({mannequin.carried(s.bone, s.a), mannequin.carried(s.bone, s.b)});
    std::vector<Pair> pairs(cells.size());
    parallel_for(std::ssize(cells), 256, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        double least = 1e300;
        for (size_t n = 0; n < lines.size(); ++n) {
          const double at = nearest_on(lines[n].first, lines[n].second, cells[i]);
          const glm::dvec3 place = glm::mix(lines[n].first, lines[n].second, at);
          const double d = glm::distance(place, cells[i]);
          if (d < least)
            least = d,
            pairs[i] = {segments[n].bone,           glm::mix(segments[n].a, segments[n].b, at), place, cells[i], {},
                        data * robust(d, 2 * width)};
        }
      }
    });
    Step step(mannequin, stage);
    for (const Pair& pair : pairs) step.add_free(pair);
    std::vector<Pair> outside;
    add_pairs(mannequin, mannequin.atlas().skin, skin, width, all * (1 - stage.bone_share), stage, outside);
    for (const Pair& pair : outside) step.add(pair);
    step.add_likings(0.05);
    mannequin = step.taken();
  }
}

namespace {

// Sums over points, which give the points' best-fit line and their mean squared distance from it.
struct Cloud {
  double count = 0;
  glm::dvec3 sum{0};
  glm::dmat3 products{0};

  void add(const glm::dvec3& p, double sign = 1) {
    count += sign, sum += sign * p, products += sign * glm::outerProduct(p, p);
  }
  Eigen::Matrix3d spread() const {
    const glm::dvec3 mean = sum / count;
    Eigen::Matrix3d C;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) C(i, j) = products[i][j] / count - mean[i] * mean[j];
    return C;
  }
  double off_line() const {
    const Eigen::Vector3d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread(), Eigen::EigenvaluesOnly).eigenvalues();
    return std::max(values[0] + values[1], 1e-3);
  }
  // Returns the point of the best-fit line that has the given coordinate along `axis`. If the line is nearly
  // perpendicular to `axis`, returns the mean of the points.
  glm::dvec3 point(const glm::dvec3& axis, double coordinate) const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread());
    const Eigen::Vector3d v = solver.eigenvectors().col(2);
    const glm::dvec3 mean = sum / count, along(v[0], v[1], v[2]);
    const double slope = glm::dot(along, axis);
    return std::abs(slope) < 0.3 ? mean : mean + along * ((coordinate - glm::dot(mean, axis)) / slope);
  }
};

// Returns the best position of the joint in a limb that runs from `a` to `b`: the position at which the bone cells on
// each side of the joint fit best to a straight line. Returns none if there are too few cells.
std::optional<glm::dvec3> parting(const std::vector<glm::dvec3>& cells, const glm::dvec3& a, const glm::dvec3& joint,
                                  const glm::dvec3& b) {
  const glm::dvec3 axis = glm::normalize(b - a);
  const double length = glm::distance(a, b), reach = 0.12 * length;
  std::vector<std::pair<double, glm::dvec3>> along;
  for (const glm::dvec3& cell : cells) {
    const double near = std::min(glm::distance(cell, glm::mix(a, joint, nearest_on(a, joint, cell))),
                                 glm::distance(cell, glm::mix(joint, b, nearest_on(joint, b, cell))));
    const double at = glm::dot(cell - a, axis);
    if (near < reach && at > 0.08 * length && at < 0.92 * length) along.push_back({at, cell - a});
  }
  std::sort(along.begin(), along.end(), [](auto& p, auto& q) { return p.first < q.first; });
  if (along.size() < 60) return std::nullopt;
  Cloud above, below;
  for (const auto& [at, p] : along) below.add(p);
  double least = 1e300, split = 0;
  Cloud best_above, best_below;
  for (size_t k = 0; k + 1 < along.size(); ++k) {
    above.add(along[k].second), below.add(along[k].second, -1);
    if (along[k].first < 0.3 * length || along[k].first > 0.7 * length || above.count < 20 || below.count < 20)
      continue;
    const double cost = above.count * std::log(above.off_line()) + below.count * std::log(below.off_line());
    if (cost < least) least = cost, split = along[k].first, best_above = above, best_below = below;
  }
  if (least == 1e300) return std::nullopt;
  return a + (best_above.point(axis, split) + best_below.point(axis, split)) / 2.0;
}

}  // namespace

void split_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells) {
  const Armature& rig = mannequin.atlas().rig;
  struct Limb {
    int upper, lower, end;
    glm::dvec3 joint, goal;
  };
  // The limbs to change, by the group of their upper bone. The left and the right limb are in one group because they
  // have a common stretch.
  std::map<int, std::vector<Limb>> limbs;
  for (int b = 0; b < mannequin.bone_count(); ++b) {
    const std::string name = without_side(rig.bones[b].name);
    if (name != "Forearm" && name != "Shank") continue;
    const int upper = rig.bones[b].parent;
    int end = -1;
    for (int c = b + 1; c < mannequin.bone_count() && end < 0; ++c)
      if (rig.bones[c].parent == b) end = c;
    if (upper < 0 || end < 0) continue;
    if (const auto joint = parting(cells, mannequin.joint(upper), mannequin.joint(b), mannequin.joint(end)))
      limbs[mannequin.group_of(upper)].push_back({upper, b, end, *joint, mannequin.joint(end)});
  }
  for (const auto& [group, pair] : limbs) {
    double above = 0, below = 0;
    for (const Limb& limb : pair) {
      above += std::log(glm::distance(mannequin.joint(limb.upper), limb.joint) /
                        glm::distance(rig.bones[limb.upper].head, rig.bones[limb.lower].head)) /
               double(pair.size());
      below += std::log(glm::distance(limb.joint, limb.goal) /
                        glm::distance(rig.bones[limb.lower].head, rig.bones[limb.end].head)) /
               double(pair.size());
    }
    mannequin.along[group] = above;
    mannequin.along[mannequin.group_of(pair[0].lower)] = below;
    mannequin.settle();
    for (const Limb& limb : pair)
      for (const auto& [bone, child, goal] :
           {std::tuple(limb.upper, limb.lower, limb.joint), std::tuple(limb.lower, limb.end, limb.goal)}) {
        const glm::dvec3 now = mannequin.joint(child) - mannequin.joint(bone), then = goal - mannequin.joint(bone);
        if (glm::length(now) > 0 && glm::length(then) > 0)
          mannequin.turn_branch(bone, glm::mat3_cast(glm::rotation(glm::normalize(now), glm::normalize(then))));
      }
  }
}

RodShare rod_share(const Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const Occupancy& bone,
                   double reach) {
  const AffineTransform to_cell = voxel_from_world(bone.grid);
  const Armature& rig = mannequin.atlas().rig;
  std::vector<std::pair<glm::dvec3, glm::dvec3>> lines;
  for (const Segment& s : segments_of(rig, {}))
    lines.push_back({mannequin.carried(s.bone, s.a), mannequin.carried(s.bone, s.b)});
  RodShare share;
  for (const glm::dvec3& cell : cells)
    share.near += std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
      return glm::distance(glm::mix(line.first, line.second, nearest_on(line.first, line.second, cell)), cell) <= reach;
    });
  share.near /= std::max<double>(1, static_cast<double>(cells.size()));
  int asked = 0, inside = 0;
  for (int b = 0; b < mannequin.bone_count(); ++b) {
    const std::string name = without_side(rig.bones[b].name);
    if (name != "UpperArm" && name != "Forearm" && name != "Thigh" && name != "Shank") continue;
    for (double t = 0.1; t < 0.95; t += 0.05) {
      const glm::dvec3 at = mannequin.carried(b, glm::mix(rig.bones[b].head, rig.bones[b].tail, t));
      ++asked;
      inside += bone.filled(
          glm::ivec3(glm::clamp(glm::floor(to_cell * at + 0.5), glm::dvec3(-1), glm::dvec3(bone.grid.size))));
    }
  }
  share.inside = asked ? double(inside) / asked : 0;
  return share;
}

double residual(const Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, double cap,
                const FitStage& within) {
  double sum = 0;
  int kinds = 0;
  const auto add = [&](const std::vector<AtlasPoint>& points, const FitSurface& surface) {
    const Asked asked(mannequin, points, surface, within);
    const std::vector<SurfacePoint>& here = asked.here;
    const PointTree tree(here);
    const auto one_way = [&](std::int64_t count, const auto& squared) {
      return parallel_sum(count, 256,
                          [&](std::int64_t begin, std::int64_t end) {
                            double part = 0;
                            for (std::int64_t i = begin; i < end; ++i) part += squared(i);
                            return part;
                          }) /
             std::max<double>(1, static_cast<double>(count));
    };
    const auto square = [&](const glm::dvec3& a, const glm::dvec3& b) {
      return std::min(cap * cap, glm::dot(a - b, a - b));
    };
    sum += one_way(std::ssize(here), [&](std::int64_t i) {
      const int n = surface.tree.nearest(here[i].place, here[i].normal, cap);
      return n < 0 ? cap * cap : square(here[i].place, surface.points[n].place);
    });
    sum += one_way(std::ssize(asked.goals), [&](std::int64_t i) {
      const SurfacePoint& goal = asked.goals[i];
      const int n = tree.nearest(goal.place, goal.normal, cap);
      return n < 0 ? cap * cap : square(goal.place, here[n].place);
    });
    kinds += 2;
  };
  if (skin) add(mannequin.atlas().skin, *skin);
  if (bone) add(mannequin.atlas().bone, *bone);
  return kinds ? sum / kinds : 0;
}

std::vector<double> share_near(const Mannequin& mannequin, const FitSurface& surface, bool bones, double near) {
  const auto& points = bones ? mannequin.atlas().bone : mannequin.atlas().skin;
  std::vector<double> all(mannequin.bone_count(), 0), close(all);
  for (const AtlasPoint& point : points) {
    const glm::dvec3 place = mannequin.carried(point.bone, point.place);
    if (beyond(surface.cuts, place) > 0) continue;
    ++all[point.bone];
    close[point.bone] +=
        surface.tree.nearest(place, mannequin.turn_at(point.bone, point.place) * point.normal, near) >= 0;
  }
  for (size_t b = 0; b < all.size(); ++b) close[b] = all[b] > 0 ? close[b] / all[b] : -1;
  return close;
}

}  // namespace limber
