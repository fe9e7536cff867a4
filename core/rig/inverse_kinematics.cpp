// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/inverse_kinematics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>

#include "core/base/error.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

constexpr int kSteps = 80;            // a search ends after at most this many steps
constexpr double kLongestStep = 0.6;  // a step that changes a parameter by more, radians, is shortened
constexpr double kAtLimit = 1e-10;    // a parameter within this distance of its limit counts as at the limit, radians
// A search ends at a step that reduces the squared distance from the targets by a smaller share than this.
constexpr double kNoProgress = 1e-6;
constexpr double kRoughly = 1e-3;  // replaces kNoProgress in a search that only prepares the next one
// Weight of the joint's distance from the half plane in which the limb bends towards its pole, relative to the distance
// of a bone's tail from its target.
constexpr double kPoleWeight = 0.1;
constexpr int kRestartsBeyondReach = 6;
// The pose that a restart finds may differ a lot from the best pose so far. It replaces the best pose only if it is
// nearer to the target by at least this share of the chain's length.
constexpr double kWorthAJump = 1e-4;

double between(std::mt19937& random, double low, double high) { return low + (high - low) * (random() / 4294967296.0); }

// A joint that the search may rotate: its limits, and the current values of the parameters of its rotation.
struct Joint {
  int bone;
  JointLimits::Type type;
  glm::dvec3 axis{0};               // axis of a hinge's rotation or of a ball joint's twist
  double minimum = 0, maximum = 0;  // limits of `angle`, radians
  double cone = 0;

  double angle = 0;  // the hinge's angle or the ball's twist, radians
  glm::dvec3 swing{0};
  glm::dquat free{1, 0, 0, 0};

  int parameters() const { return type == JointLimits::Type::Fixed ? 0 : type == JointLimits::Type::Hinge ? 1 : 3; }

  glm::dquat rotation() const {
    switch (type) {
      case JointLimits::Type::Free: return free;
      case JointLimits::Type::Fixed: return {1, 0, 0, 0};
      case JointLimits::Type::Hinge: return exponential(angle * axis);
      case JointLimits::Type::Ball: return rotation_of({swing, angle}, axis);
    }
    return free;
  }

  // Returns the two directions in which the parameters of a ball joint change its swing: away from the rest pose, and
  // around the rest pose at the same distance.
  std::array<glm::dvec3, 2> swing_directions() const {
    const double length = glm::length(swing);
    glm::dvec3 outward = swing;
    if (length < 1e-12) {
      const glm::dvec3 across = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      outward = across - axis * glm::dot(axis, across);
    }
    outward = glm::normalize(outward);
    return {outward, glm::cross(axis, outward)};
  }

  // Writes to `out`, for each parameter of the joint, the axis about which the bone turns when the parameter changes a
  // little. The axes are in the parent's rest frame.
  void turning_axes(glm::dvec3* out) const {
    if (type == JointLimits::Type::Hinge) out[0] = axis;
    if (type == JointLimits::Type::Free)
      for (int i = 0; i < 3; ++i) out[i] = glm::dvec3(i == 0, i == 1, i == 2);
    if (type != JointLimits::Type::Ball) return;
    // Derivative of the exponential map at the swing s, with a = |s| and the matrix [s] of the cross product with s: I
    // + (1 - cos a)/a^2 [s] + (a - sin a)/a^3 [s]^2.
    const double a = glm::length(swing);
    const double first = a < 1e-4 ? 0.5 : (1 - std::cos(a)) / (a * a);
    const double second = a < 1e-4 ? 1.0 / 6 : (a - std::sin(a)) / (a * a * a);
    const auto directions = swing_directions();
    for (int i = 0; i < 2; ++i) {
      const glm::dvec3 once = glm::cross(swing, directions[i]);
      out[i] = directions[i] + first * once + second * glm::cross(swing, once);
    }
    out[2] = exponential(swing) * axis;
  }

  // Returns true if parameter i is at its limit and adding `push` would exceed the limit.
  bool is_held(int i, double push) const {
    if (type == JointLimits::Type::Free) return false;
    if (type == JointLimits::Type::Ball && i == 0) return push > 0 && glm::length(swing) >= cone - kAtLimit;
    if (type == JointLimits::Type::Ball && i == 1) return cone <= kAtLimit;
    return (push > 0 && angle >= maximum - kAtLimit) || (push < 0 && angle <= minimum + kAtLimit);
  }

  void change(const double* by) {
    switch (type) {
      case JointLimits::Type::Fixed: break;
      case JointLimits::Type::Free: free = glm::normalize(exponential({by[0], by[1], by[2]}) * free); break;
      case JointLimits::Type::Hinge: angle = std::clamp(angle + by[0], minimum, maximum); break;
      case JointLimits::Type::Ball: {
        const auto directions = swing_directions();
        swing += by[0] * directions[0] + by[1] * directions[1];
        if (const double length = glm::length(swing); length > cone) swing *= cone / length;
        angle = std::clamp(angle + by[2], minimum, maximum);
      }
    }
  }

  void scatter(std::mt19937& random) {
    angle = between(random, minimum, maximum);
    const auto directions = swing_directions();
    const double around = between(random, 0, 2 * std::numbers::pi), away = cone * std::sqrt(between(random, 0, 1));
    swing = away * (std::cos(around) * directions[0] + std::sin(around) * directions[1]);
    free = exponential(2.0 * glm::dvec3(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)));
  }
};

Joint joint_of(const Bone& bone, int index, const glm::dquat& rotation, bool keep_limits) {
  Joint joint{index, keep_limits ? bone.limits.type : JointLimits::Type::Free};
  joint.free = rotation;
  const glm::dquat allowed = keep_limits ? within_limits(bone, rotation) : rotation;
  if (joint.type == JointLimits::Type::Hinge) {
    joint.axis = bone.limits.axis;
    joint.minimum = bone.limits.minimum;
    joint.maximum = bone.limits.maximum;
  } else if (joint.type == JointLimits::Type::Ball) {
    joint.axis = twist_axis(bone);
    joint.minimum = bone.limits.twist_minimum;
    joint.maximum = bone.limits.twist_maximum;
    joint.cone = std::min(bone.limits.cone, std::numbers::pi - 1e-6);  // half a turn has no unique direction
  } else {
    return joint;
  }
  const SwingTwist parts = swing_twist(allowed, joint.axis);
  joint.swing = parts.swing;
  joint.angle = parts.twist;
  for (double turn : {2 * std::numbers::pi, -2 * std::numbers::pi})
    if (joint.angle < joint.minimum - 1e-6 || joint.angle > joint.maximum + 1e-6)
      if (parts.twist + turn >= joint.minimum - 1e-6 && parts.twist + turn <= joint.maximum + 1e-6)
        joint.angle = parts.twist + turn;
  joint.angle = std::clamp(joint.angle, joint.minimum, joint.maximum);
  if (const double length = glm::length(joint.swing); length > joint.cone) joint.swing *= joint.cone / length;
  return joint;
}

struct State {
  std::vector<Joint> joints;  // one joint for each bone that may move, parents before children
  glm::dvec3 root{0};
};

class Search {
 public:
  Search(const Armature& armature, const Pose& start, const std::vector<ReachGoal>& goals,
         const ReachSettings& settings)
      : armature_(armature),
        start_(start),
        settings_(settings) {
    const auto n = armature.bones.size();
    std::vector<bool> needed(n, false), moves(n, false);
    for (const ReachGoal& goal : goals) {
      Goal mine{goal.bone, goal.target, goal.weight, goal.bone, 0, {}};
      mine.moved_by.resize(n, false);
      int left = goal.chain > 0 ? goal.chain : static_cast<int>(n);
      for (int b = goal.bone; b >= 0; b = armature.bones[b].parent) {
        needed[b] = true;
        if (left-- <= 0) continue;
        moves[b] = true;
        mine.moved_by[b] = true;
        mine.first = b;
        mine.length += length_of(b);
      }
      goals_.push_back(mine);
    }
    for (size_t b = 0; b < n; ++b) {
      if (!needed[b]) continue;
      needed_.push_back(static_cast<int>(b));
      joint_of_.push_back(moves[b] ? static_cast<int>(initial_.joints.size()) : -1);
      if (moves[b])
        initial_.joints.push_back(joint_of(armature.bones[b], int(b), start.rotation[b], settings.keep_limits));
    }
    initial_.root = start.root_translation;
    posed_.resize(n);
    for (const Joint& joint : initial_.joints) parameters_ += joint.parameters();
    if (settings.move_root) parameters_ += 3;
  }

  Reach run() {
    State best = from(initial_);
    double nearest = furthest_off(best);
    std::mt19937 random(20240521);
    const int restarts = lies_beyond_reach() ? std::min(settings_.restarts, kRestartsBeyondReach) : settings_.restarts;
    for (int i = 0; i < restarts && nearest > settings_.tolerance && parameters_ > 0; ++i) {
      State next = initial_;
      // The first two restarts begin close to the start pose: if its chain is straight, the gradient is zero, and a
      // small random bend is enough to leave it. Later restarts begin at random poses.
      for (Joint& joint : next.joints) {
        Joint other = joint;
        other.scatter(random);
        if (i < 2) nudge(joint, other);
        else joint = other;
      }
      const State found = from(next);
      const double distance = furthest_off(found);
      if (distance > settings_.tolerance && distance > nearest - kWorthAJump * goals_[0].length) continue;
      best = found;
      nearest = distance;
    }
    Reach result{start_, nearest, nearest <= settings_.tolerance};
    for (const Joint& joint : best.joints) result.pose.rotation[joint.bone] = joint.rotation();
    result.pose.root_translation = best.root;
    return result;
  }

 private:
  struct Goal {
    int bone;
    glm::dvec3 target;
    double weight;
    int first;      // index of the bone at the upper end of the chain that moves to reach this goal
    double length;  // length of this chain, mm
    std::vector<bool> moved_by;
  };

  double length_of(int b) const {
    const Bone& bone = armature_.bones[b];
    const double own = glm::distance(bone.head, bone.tail);
    return bone.parent < 0 ? own : own + glm::distance(bone.head, armature_.bones[bone.parent].tail);
  }

  // Returns true if the distance between a target and the base of its chain exceeds the chain's length.
  bool lies_beyond_reach() {
    place(initial_);
    return !settings_.move_root && std::any_of(goals_.begin(), goals_.end(), [&](const Goal& goal) {
      return glm::distance(goal.target, pivot(goal.first)) > goal.length;
    });
  }

  static void nudge(Joint& joint, const Joint& towards) {
    constexpr double kShare = 0.15;
    joint.angle += kShare * (towards.angle - joint.angle);
    joint.swing += kShare * (towards.swing - joint.swing);
    joint.free = glm::normalize(glm::slerp(joint.free, towards.free, kShare));
  }

  void place(const State& state) {
    for (size_t i = 0; i < needed_.size(); ++i) {
      const int b = needed_[i];
      const Bone& bone = armature_.bones[b];
      const glm::dquat rotation = joint_of_[i] < 0 ? start_.rotation[b] : state.joints[joint_of_[i]].rotation();
      const RigidTransform own = rotation_about(bone.head, rotation);
      posed_[b] =
          bone.parent < 0 ? RigidTransform{own.rotation, own.translation + state.root} : posed_[bone.parent] * own;
    }
  }

  glm::dvec3 tip(const Goal& goal) const { return posed_[goal.bone] * armature_.bones[goal.bone].tail; }
  glm::dvec3 pivot(int b) const { return posed_[b] * armature_.bones[b].head; }

  double furthest_off(const State& state) {
    place(state);
    double furthest = 0;
    for (const Goal& goal : goals_) furthest = std::max(furthest, glm::distance(tip(goal), goal.target));
    return furthest;
  }

  // Runs the search from a start state. If a target is beyond the chain's reach, a first search aims at the reachable
  // point nearest to it, from which the final search needs few steps.
  State from(State state) {
    place(state);
    std::vector<glm::dvec3> targets;
    bool drawn = false;
    for (const Goal& goal : goals_) {
      const glm::dvec3 base = pivot(goal.first), off = goal.target - base;
      const double away = glm::length(off);
      const bool far = away > goal.length && !settings_.move_root;
      targets.push_back(far ? base + off * (goal.length / away) : goal.target);
      drawn |= far;
    }
    if (settings_.pole) state = search(std::move(state), targets, true, kNoProgress);
    if (drawn) state = search(std::move(state), targets, false, kRoughly);
    for (size_t g = 0; g < goals_.size(); ++g) targets[g] = goals_[g].target;
    return search(std::move(state), targets, false, kNoProgress);
  }

  int rows(bool pole) const { return static_cast<int>(3 * goals_.size()) + (pole ? 1 : 0); }

  // The pole wants the last joint of the first chain in the half plane that contains the pole and is bounded by the
  // line from the chain's base to its tip. Returns the distance, mm, of this joint from its wanted position, the point
  // of the half plane that is as far from the line as the joint is.
  //   normal  set to the unit direction from the joint to the wanted position
  double beside_pole(glm::dvec3& normal) const {
    const Goal& goal = goals_[0];
    const glm::dvec3 base = pivot(goal.first), along = tip(goal) - base, joint = pivot(goal.bone) - base;
    glm::dvec3 towards = *settings_.pole - base;
    const double squared = glm::dot(along, along);
    if (squared < 1e-12) return 0;
    towards -= along * (glm::dot(towards, along) / squared);
    const double length = glm::length(towards);
    if (length < 1e-9) return 0;
    towards /= length;
    const glm::dvec3 across = joint - along * (glm::dot(joint, along) / squared);
    normal = glm::length(across) * towards - across;  // vector from the joint to its wanted position
    const double off = glm::length(normal);
    if (off > 0) normal /= off;
    return off;
  }

  void errors(const std::vector<glm::dvec3>& targets, bool pole, Eigen::VectorXd& e, glm::dvec3& pole_normal) const {
    for (size_t g = 0; g < goals_.size(); ++g) {
      const glm::dvec3 off = goals_[g].weight * (targets[g] - tip(goals_[g]));
      for (int axis = 0; axis < 3; ++axis) e[3 * g + axis] = off[axis];
    }
    if (pole) e[rows(true) - 1] = kPoleWeight * beside_pole(pole_normal);
  }

  void jacobian(const State& state, bool pole, const glm::dvec3& pole_normal, Eigen::MatrixXd& J) const {
    J.setZero();
    int column = 0;
    for (const Joint& joint : state.joints) {
      glm::dvec3 axes[3];
      joint.turning_axes(axes);
      const int parent = armature_.bones[joint.bone].parent;
      const glm::dvec3 at = pivot(joint.bone);
      for (int i = 0; i < joint.parameters(); ++i, ++column) {
        const glm::dvec3 axis = parent < 0 ? axes[i] : posed_[parent].rotation * axes[i];
        for (size_t g = 0; g < goals_.size(); ++g)
          if (goals_[g].moved_by[joint.bone]) {
            const glm::dvec3 moved = goals_[g].weight * glm::cross(axis, tip(goals_[g]) - at);
            for (int r = 0; r < 3; ++r) J(3 * g + r, column) = moved[r];
          }
        if (pole && goals_[0].moved_by[joint.bone])
          J(rows(true) - 1, column) = kPoleWeight * glm::dot(pole_normal, glm::cross(axis, pivot(goals_[0].bone) - at));
      }
    }
    if (settings_.move_root)
      for (int i = 0; i < 3; ++i, ++column)
        for (size_t g = 0; g < goals_.size(); ++g) J(3 * g + i, column) = goals_[g].weight;
  }

  // Computes a step of damped least squares. If the step would change parameters beyond their limits, computes it again
  // without these parameters.
  Eigen::VectorXd damped_step(const State& state, const Eigen::VectorXd& e, const Eigen::MatrixXd& J,
                              double damping) const {
    Eigen::MatrixXd free = J;
    Eigen::VectorXd step;
    for (int round = 0; round < 4; ++round) {
      Eigen::MatrixXd normal = free * free.transpose();
      normal.diagonal().array() += damping;
      step = free.transpose() * normal.llt().solve(e);
      bool again = false;
      int column = 0;
      for (const Joint& joint : state.joints)
        for (int i = 0; i < joint.parameters(); ++i, ++column)
          if (step[column] != 0 && joint.is_held(i, step[column])) {
            free.col(column).setZero();
            step[column] = 0;
            again = true;
          }
      if (!again) break;
    }
    const double largest =
        step.size() ? step.head(step.size() - (settings_.move_root ? 3 : 0)).cwiseAbs().maxCoeff() : 0;
    if (largest > kLongestStep) step *= kLongestStep / largest;
    return step;
  }

  void change(State& state, const Eigen::VectorXd& step) const {
    int column = 0;
    for (Joint& joint : state.joints) {
      joint.change(step.data() + column);
      column += joint.parameters();
    }
    if (settings_.move_root) state.root += glm::dvec3(step[column], step[column + 1], step[column + 2]);
  }

  bool has_arrived(const std::vector<glm::dvec3>& targets) const {
    bool arrived = true;
    for (size_t g = 0; g < goals_.size(); ++g)
      arrived &= glm::distance(tip(goals_[g]), targets[g]) <= 0.5 * settings_.tolerance;
    return arrived;
  }

  // Minimizes the distances from the targets, starting from the given state. The damping is scaled by the mean squared
  // lever arm of the chain (mm^2 per radian^2), so that it does not depend on the rig's size.
  State search(State state, const std::vector<glm::dvec3>& targets, bool pole, double no_progress) {
    if (parameters_ == 0) return state;
    Eigen::VectorXd e(rows(pole));
    Eigen::MatrixXd J(rows(pole), parameters_);
    glm::dvec3 pole_normal(0);
    place(state);
    errors(targets, pole, e, pole_normal);
    double error = e.squaredNorm(), damping = 1e-3;
    for (int i = 0; i < kSteps && !(has_arrived(targets) && !pole); ++i) {
      jacobian(state, pole, pole_normal, J);
      const double lever = std::max(J.squaredNorm() / J.rows(), 1e-12);
      bool better = false;
      double gained = 0;
      while (!better && damping < 1e8) {
        State next = state;
        change(next, damped_step(state, e, J, damping * lever));
        place(next);
        Eigen::VectorXd after(e.size());
        errors(targets, pole, after, pole_normal);
        better = after.squaredNorm() < error;
        if (better) {
          gained = error - after.squaredNorm();
          error = after.squaredNorm();
          e = after;
          state = std::move(next);
          damping = std::max(damping * 0.2, 1e-9);
        } else {
          damping *= 6;
        }
      }
      if (!better) {
        place(state);
        break;
      }
      if (gained < no_progress * error) break;
    }
    return state;
  }

  const Armature& armature_;
  const Pose& start_;
  const ReachSettings& settings_;
  std::vector<Goal> goals_;
  // needed_: the bones of the goals and all bones above them. joint_of_: for each entry of needed_, the bone's index in
  // State::joints, or -1 if the bone does not move.
  std::vector<int> needed_, joint_of_;
  State initial_;
  int parameters_ = 0;
  std::vector<RigidTransform> posed_;
};

}  // namespace

Reach reach(const Armature& armature, const Pose& start, const std::vector<ReachGoal>& goals,
            const ReachSettings& settings) {
  if (goals.empty()) return {start, 0, true};
  for (const ReachGoal& goal : goals) {
    if (goal.bone < 0 || goal.bone >= std::ssize(armature.bones))
      throw Error("there is no such bone", "goal for bone " + std::to_string(goal.bone), "name one of the rig's bones");
    if (!std::isfinite(goal.target.x + goal.target.y + goal.target.z))
      throw Error("the target is not a position", "goal for bone " + armature.bones[goal.bone].name,
                  "give three finite numbers");
  }
  return Search(armature, start, goals, settings).run();
}

}  // namespace limber
