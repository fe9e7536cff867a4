// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/joint_axis_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include <Eigen/Dense>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/distance_transform.h"
#include "core/volume/label_sampler.h"

namespace limber {

namespace {
constexpr double kDegree = std::numbers::pi / 180;
// Step between the joint angles at which the fit measures collisions, degrees. The margin around bones allows for the
// angles in between.
constexpr double kFitStep = 3;
constexpr double kVerifyStep = 1;  // step between the joint angles at which colliding voxels are counted, degrees
constexpr double kLever = 100;     // a shift of the axis by this length costs as much as a tilt by one radian, mm
// Collision depth, mm, below which the cost is about quadratic; above it the cost is linear.
constexpr double kRound = 0.2;
// Bone that at all angles is farther than this from the bones on the other side of the joint is ignored, mm.
constexpr double kNear = 20;

// A change of the joint's axis, all in mm: shifts along the two directions perpendicular to the axis, and tilts towards
// them (radians times kLever).
using Motion4 = Eigen::Vector4d;

struct Axis {
  glm::dvec3 place, direction;  // a point on the axis (world, mm), and the axis's unit direction
};

// The joint's axis before the fit, and two unit vectors perpendicular to it along which it may be shifted or tilted.
struct AxisFrame {
  Axis axis;
  glm::dvec3 across[2];

  explicit AxisFrame(const Axis& at) : axis(at) {
    const glm::dvec3 a = glm::abs(axis.direction);
    const glm::dvec3 least = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                             : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                      : glm::dvec3(0, 0, 1);
    across[0] = glm::normalize(glm::cross(axis.direction, least));
    across[1] = glm::cross(axis.direction, across[0]);
  }

  Axis moved(const Motion4& motion) const {
    return {axis.place + motion[0] * across[0] + motion[1] * across[1],
            glm::normalize(axis.direction + (motion[2] * across[0] + motion[3] * across[1]) / kLever)};
  }
};

AffineTransform affine(const RigidTransform& rigid) { return {glm::mat3_cast(rigid.rotation), rigid.translation}; }
AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
  return {a.linear * b.linear, a.linear * b.offset + a.offset};
}

// Returns a rotation by `radians` about the axis as a transform of voxel coordinates.
AffineTransform turned_voxel(const Grid& grid, const Axis& axis, double radians) {
  const RigidTransform turn = rotation_about(axis.place, glm::angleAxis(radians, axis.direction));
  return voxel_from_world(grid) * affine(turn) * world_from_voxel(grid);
}

// The bone voxels on one side of the joint: those of the fixed bones, or those of the rotating bones.
struct Side {
  VoxelBox box;                      // bounding box of the voxels, with a margin of three voxels
  std::vector<std::uint8_t> inside;  // 1 for each voxel of the box that belongs to this side
  std::vector<glm::ivec3> voxels;

  bool has(const glm::ivec3& v) const { return box.contains(v) && inside[box.index(v)]; }
};

Side gather_side(const std::vector<glm::ivec3>& voxels) {
  Side side{.voxels = voxels};
  glm::ivec3 low(voxels[0]), high(voxels[0]);
  for (const glm::ivec3& v : voxels) {
    low = glm::min(low, v);
    high = glm::max(high, v);
  }
  side.box = {low - 3, high - low + 7};
  side.inside.assign(side.box.voxel_count(), 0);
  for (const glm::ivec3& v : voxels) side.inside[side.box.index(v)] = 1;
  return side;
}

// Decides which side of the joint owns the bone at a rest point, by the same rule by which rigid bones are written into
// a posed volume (core/deform/inverse_map.h): the label read at the point is bone, and the side of the nearest bone
// voxel owns the point.
class PaintedBone {
 public:
  PaintedBone(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts, const Side& fixed,
              const Side& turning)
      : sampler_(volume),
        is_bone_(65536),
        fixed_(fixed),
        turning_(turning) {
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      if (parts.part_of[place]) is_bone_[volume.at(v)] = 1;
    });
  }

  bool by_turning(const glm::dvec3& point) const {
    const glm::ivec3 nearest(glm::floor(point + 0.5));
    if (!turning_.box.contains(nearest) || !is_bone_[sampler_.tissue(point)]) return false;
    if (turning_.has(nearest)) return true;
    if (fixed_.has(nearest)) return false;
    double least = std::numeric_limits<double>::infinity();
    bool turning = false;
    for (int k = 0; k < 27; ++k) {
      const glm::ivec3 v = nearest + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const glm::dvec3 away = glm::dvec3(v) - point;
      if (glm::dot(away, away) >= least || (!turning_.has(v) && !fixed_.has(v))) continue;
      least = glm::dot(away, away);
      turning = turning_.has(v);
    }
    return turning;
  }

 private:
  LabelSampler sampler_;
  LabelSet is_bone_;
  const Side &fixed_, &turning_;
};

// Returns the signed distance of each voxel of the box to the surface of one side's bones, mm, negative inside.
std::vector<float> surface_distance(const Side& side, const glm::dvec3& spacing, Progress& progress) {
  std::vector<float> distance = signed_distance(side.box, side.inside, spacing, progress);
  // Converts distances between voxel centres to distances from the face between a bone voxel and its neighbour.
  const auto half = static_cast<float>(std::min({spacing.x, spacing.y, spacing.z}) / 2);
  for (float& d : distance) d += d > 0 ? -half : half;
  return distance;
}

// An interpolated value of a field, and the field's gradient per voxel.
struct Sampled {
  double value;
  glm::dvec3 gradient;
};
std::optional<Sampled> sample(const VoxelBox& box, const std::vector<float>& field, const glm::dvec3& point) {
  const glm::dvec3 floor = glm::floor(point);
  const glm::ivec3 low(floor);
  if (!box.contains(low) || !box.contains(low + 1)) return std::nullopt;
  const float* at = &field[box.index(low)];
  const std::int64_t row = box.size.x, slice = row * box.size.y;
  const glm::dvec3 f = point - floor;
  const double c[2][2][2] = {{{at[0], at[1]}, {at[row], at[row + 1]}},
                             {{at[slice], at[slice + 1]}, {at[slice + row], at[slice + row + 1]}}};
  Sampled result{0, glm::dvec3(0)};
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        const glm::dvec3 w(x ? f.x : 1 - f.x, y ? f.y : 1 - f.y, z ? f.z : 1 - f.z);
        const double value = c[z][y][x];
        result.value += w.x * w.y * w.z * value;
        result.gradient +=
            value * glm::dvec3((x ? 1 : -1) * w.y * w.z, (y ? 1 : -1) * w.x * w.z, (z ? 1 : -1) * w.x * w.y);
      }
  return result;
}

// Returns the field's value at the voxel nearest to a point; infinity outside the box.
float nearest_value(const VoxelBox& box, const std::vector<float>& field, const glm::dvec3& point) {
  const glm::dvec3 at = point - glm::dvec3(box.lowest) + 0.5;
  const bool inside =
      at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < box.size.x && at.y < box.size.y && at.z < box.size.z;
  if (!inside) return std::numeric_limits<float>::infinity();
  return field[static_cast<int>(at.x) +
               std::int64_t{box.size.x} * (static_cast<int>(at.y) + std::int64_t{box.size.y} * static_cast<int>(at.z))];
}

std::vector<double> angles_between(double minimum_degrees, double maximum_degrees, double step) {
  const int count = std::max(1, static_cast<int>(std::ceil((maximum_degrees - minimum_degrees) / step - 1e-9)));
  std::vector<double> angles;
  for (int i = 0; i <= count; ++i)
    angles.push_back((minimum_degrees + (maximum_degrees - minimum_degrees) * i / count) * kDegree);
  return angles;
}

// The summed cost of all collisions (surface voxels closer to the other bone than the margin), with its gradient and
// Gauss-Newton Hessian.
struct Collision {
  double cost = 0;
  Motion4 gradient = Motion4::Zero();
  Eigen::Matrix4d curvature = Eigen::Matrix4d::Zero();

  Collision& operator+=(const Collision& other) {
    cost += other.cost;
    gradient += other.gradient;
    curvature += other.curvature;
    return *this;
  }
};

class JointProblem {
 public:
  JointProblem(const Grid& grid, const Side& fixed, const Side& turning, const PaintedBone& painted, const Axis& axis,
               const FitJoint& settings, Progress& progress)
      : grid_(grid),
        fixed_(fixed),
        turning_(turning),
        painted_(painted),
        frame_(axis),
        progress_(progress),
        fit_angles_(angles_between(settings.minimum_degrees, settings.maximum_degrees, kFitStep)),
        verify_angles_(angles_between(settings.minimum_degrees, settings.maximum_degrees, kVerifyStep)),
        from_fixed_(surface_distance(fixed, grid.spacing, progress)),
        from_turning_(surface_distance(turning, grid.spacing, progress)),
        reach_(glm::length(grid.spacing)) {
    choose_points();
  }

  const AxisFrame& frame() const { return frame_; }

  // Number of voxels that bones of both sides would fill: at the worst angle of the range, and summed over all angles.
  struct Overlap {
    std::int64_t most = 0, sum = 0;
  };
  Overlap overlap(const Motion4& motion) const {
    const Axis axis = frame_.moved(motion);
    std::vector<std::int64_t> count(verify_angles_.size());
    parallel_for(std::ssize(count), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) {
        const AffineTransform back = turned_voxel(grid_, axis, -verify_angles_[k]);
        for (const glm::ivec3& v : exposed_) count[k] += is_entered(back * glm::dvec3(v));
      }
    });
    return {*std::max_element(count.begin(), count.end()),
            std::accumulate(count.begin(), count.end(), std::int64_t{0})};
  }

  // Returns the rest positions of the voxels of both sides that collide at some angle. Each voxel is listed once, in
  // grid order (x fastest).
  std::vector<glm::ivec3> colliding(const Motion4& motion) const {
    const Axis axis = frame_.moved(motion);
    std::vector<glm::ivec3> all;
    for (const double angle : verify_angles_) {
      const AffineTransform back = turned_voxel(grid_, axis, -angle);
      for (const glm::ivec3& v : exposed_) {
        const glm::dvec3 rest = back * glm::dvec3(v);
        if (!is_entered(rest)) continue;
        all.push_back(v);
        if (const glm::ivec3 nearest(glm::floor(rest + 0.5)); turning_.has(nearest)) all.push_back(nearest);
      }
    }
    const auto order = [](const glm::ivec3& a, const glm::ivec3& b) {
      return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
    };
    std::sort(all.begin(), all.end(), order);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  // Returns the motion of the axis that minimizes |motion|^2 plus `weight` times the cost of collisions. The search
  // starts at the given `motion`.
  Motion4 solve(Motion4 motion, double weight, double margin) const {
    constexpr int kIterations = 12;
    double damping = 1e-3;
    double cost = motion.squaredNorm() + weight * collision(motion, margin).cost;
    for (int i = 0; i < kIterations; ++i) {
      progress_.update("fit joint", 0.5);
      const Collision at = collision(motion, margin);
      const Motion4 gradient = motion + weight * at.gradient;
      Eigen::Matrix4d curvature = Eigen::Matrix4d::Identity() + weight * at.curvature;
      const Eigen::Matrix4d damped = curvature + damping * Eigen::Matrix4d(curvature.diagonal().asDiagonal());
      const Motion4 next = motion - damped.ldlt().solve(gradient);
      const double next_cost = next.squaredNorm() + weight * collision(next, margin).cost;
      if (next_cost >= cost) {
        damping *= 10;
        if (damping > 1e6) break;
        continue;
      }
      const bool settled = cost - next_cost < 1e-4 * cost;
      motion = next;
      cost = next_cost;
      damping = std::max(damping / 10, 1e-6);
      if (settled) break;
    }
    return motion;
  }

 private:
  // Selects the voxels of each side that come near the bones of the other side at some angle: all such voxels of the
  // fixed side, but only surface voxels of the rotating side.
  void choose_points() {
    std::vector<AffineTransform> there, back;
    for (double angle : fit_angles_) {
      there.push_back(turned_voxel(grid_, frame_.axis, angle));
      back.push_back(turned_voxel(grid_, frame_.axis, -angle));
    }
    for (const glm::ivec3& v : turning_.voxels) {
      const std::int64_t row = turning_.box.size.x, slice = row * turning_.box.size.y;
      const std::uint8_t* in = &turning_.inside[turning_.box.index(v)];
      const bool deep = in[-1] && in[1] && in[-row] && in[row] && in[-slice] && in[slice];
      if (!deep && comes_near(v, there, fixed_.box, from_fixed_)) points_.push_back(glm::dvec3(v));
    }
    for (const glm::ivec3& v : fixed_.voxels)
      if (comes_near(v, back, turning_.box, from_turning_)) exposed_.push_back(v);
  }

  // Returns true if bone of the rotating side enters a voxel of the fixed side.
  //   rest  the rest point that the rotation moves to the voxel
  bool is_entered(const glm::dvec3& rest) const {
    return nearest_value(turning_.box, from_turning_, rest) < reach_ && painted_.by_turning(rest);
  }

  bool comes_near(const glm::ivec3& v, const std::vector<AffineTransform>& turns, const VoxelBox& box,
                  const std::vector<float>& distance) const {
    const glm::dvec3 wide = kNear / grid_.spacing;
    const glm::dvec3 low = glm::dvec3(box.lowest) - wide, high = glm::dvec3(box.lowest + box.size) + wide;
    return std::any_of(turns.begin(), turns.end(), [&](const AffineTransform& turn) {
      const glm::dvec3 p = turn * glm::dvec3(v);
      if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) return false;
      const auto there = sample(box, distance, p);
      return !there || there->value < kNear;
    });
  }

  Collision collision(const Motion4& motion, double margin) const {
    const Axis axis = frame_.moved(motion);
    std::array<Axis, 4> stepped;
    constexpr double kStep = 1e-4;  // step of the finite differences of a motion, mm
    for (int j = 0; j < 4; ++j) stepped[j] = frame_.moved(motion + kStep * Motion4::Unit(j));

    std::vector<Collision> parts(fit_angles_.size());
    parallel_for(std::ssize(parts), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) {
        const AffineTransform turn = turned_voxel(grid_, axis, fit_angles_[k]);
        std::array<AffineTransform, 4> change;
        for (int j = 0; j < 4; ++j) {
          const AffineTransform there = turned_voxel(grid_, stepped[j], fit_angles_[k]);
          change[j] = {(there.linear - turn.linear) / kStep, (there.offset - turn.offset) / kStep};
        }
        for (const glm::dvec3& point : points_) {
          const glm::dvec3 at = turn * point;
          if (nearest_value(fixed_.box, from_fixed_, at) > margin + reach_) continue;
          const auto there = sample(fixed_.box, from_fixed_, at);
          if (!there || there->value >= margin) continue;
          const double depth = margin - there->value;
          Motion4 slope;
          for (int j = 0; j < 4; ++j) slope[j] = -glm::dot(there->gradient, change[j] * point);
          const double rounded = std::sqrt(depth * depth + kRound * kRound);
          parts[k].cost += 2 * (rounded - kRound);
          parts[k].gradient += depth / rounded * slope;
          parts[k].curvature += slope * slope.transpose() / rounded;
        }
      }
    });
    Collision sum;
    for (const Collision& part : parts) sum += part;
    return sum;
  }

  const Grid& grid_;
  const Side &fixed_, &turning_;
  const PaintedBone& painted_;
  AxisFrame frame_;
  Progress& progress_;
  std::vector<double> fit_angles_, verify_angles_;
  std::vector<float> from_fixed_, from_turning_;  // signed distances to each side's bones in that side's box, mm
  double reach_;                                  // diagonal of a voxel, mm
  std::vector<glm::dvec3> points_;   // surface voxels of the rotating side that may enter bone of the fixed side
  std::vector<glm::ivec3> exposed_;  // voxels of the fixed side that bone of the rotating side may enter
};

struct Fit {
  Motion4 motion = Motion4::Zero();
  JointProblem::Overlap overlap;
};

bool within(const Motion4& motion, const FitJoint& settings) {
  return motion.head<2>().norm() <= settings.most_moved_mm &&
         std::atan(motion.tail<2>().norm() / kLever) <= settings.most_turned_degrees * kDegree;
}

// Returns true if fit `a` has fewer collisions than fit `b`, or as many collisions and a smaller motion.
bool better(const Fit& a, const Fit& b) {
  if (a.overlap.sum != b.overlap.sum) return a.overlap.sum < b.overlap.sum;
  return a.motion.squaredNorm() < b.motion.squaredNorm();
}

// Improves a fit by trying steps along one or two of the four variables of the motion; if no step helps, the step is
// halved [Hooke & Jeeves 1961]. First the remaining collisions are removed, then the motion is shortened. Derivatives
// cannot be used, because voxel counts are not differentiable.
Fit polish(const JointProblem& problem, Fit best, const FitJoint& settings) {
  for (double step = 2; step > 0.2; step /= 2) {
    for (bool moved = true; moved;) {
      moved = false;
      Fit next = best;
      for (int direction = 0; direction < 81; ++direction) {
        const Eigen::Vector4d way(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 % 3 - 1, direction / 27 - 1);
        if (way.squaredNorm() == 0 || way.squaredNorm() > 2) continue;
        Fit tried{best.motion + step * way, {}};
        if (!within(tried.motion, settings)) continue;
        if (best.overlap.sum == 0 && tried.motion.squaredNorm() >= next.motion.squaredNorm()) continue;
        tried.overlap = problem.overlap(tried.motion);
        if (better(tried, next)) {
          next = tried;
          moved = true;
        }
      }
      best = next;
    }
  }
  return best;
}

// Returns the smallest motion of the axis found without collisions; if none was found, the motion with the fewest
// collisions.
Fit least_motion(const JointProblem& problem, double voxel, const FitJoint& settings) {
  Fit best{Motion4::Zero(), problem.overlap(Motion4::Zero())};
  // With a smaller margin around bones the axis moves less. If voxels still collide, the larger margin opens the joint
  // more.
  for (const double margin : {0.375 * voxel, 0.75 * voxel}) {
    Motion4 motion = Motion4::Zero();
    for (double weight = 1.0 / 16; weight <= 256 && best.overlap.sum; weight *= 8) {
      motion = problem.solve(motion, weight, margin);
      if (!within(motion, settings)) break;
      const Fit fit{motion, problem.overlap(motion)};
      if (better(fit, best)) best = fit;
    }
    best = polish(problem, best, settings);
    if (best.overlap.sum == 0) break;
  }
  return best;
}

// Returns the bones that rotate with `bone`: the bone itself and its descendants.
std::vector<bool> turning_bones(const Armature& armature, int bone) {
  std::vector<bool> turns(armature.bones.size());
  turns[bone] = true;
  for (size_t i = bone + 1; i < turns.size(); ++i)
    turns[i] = armature.bones[i].parent >= 0 && turns[armature.bones[i].parent];
  return turns;
}

struct Sides {
  std::vector<glm::ivec3> fixed, turning;
};

Sides split_sides(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                  const Armature& armature, int bone, double reach) {
  const std::vector<bool> turns = turning_bones(armature, bone);
  const AffineTransform to_world = world_from_voxel(volume.grid);
  const glm::dvec3 head = armature.bones[bone].head;
  Sides sides;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const int part = parts.part_of[place];
    if (!part || glm::length(to_world * glm::dvec3(v) - head) > reach) return;
    (turns[parts.parts[part - 1].bone] ? sides.turning : sides.fixed).push_back(v);
  });
  return sides;
}

struct AxisFit {
  Axis axis;
  double moved_mm = 0, turned_degrees = 0;
  std::int64_t overlap_before = 0, overlap_after = 0;
  std::vector<glm::ivec3> colliding_before, colliding_after;
};

AxisFit fit_axis(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts, const Sides& sides,
                 const Axis& axis, const FitJoint& settings, Progress& progress) {
  progress.update("fit joint", 0);
  const Side fixed = gather_side(sides.fixed), turning = gather_side(sides.turning);
  const PaintedBone painted(volume, tissue, parts, fixed, turning);
  const JointProblem problem(volume.grid, fixed, turning, painted, axis, settings, progress);
  const glm::dvec3 spacing = volume.grid.spacing;
  const Fit fit = least_motion(problem, std::min({spacing.x, spacing.y, spacing.z}), settings);
  AxisFit fitted{.axis = problem.frame().moved(fit.motion)};
  fitted.moved_mm = fit.motion.head<2>().norm();
  fitted.turned_degrees = std::atan(fit.motion.tail<2>().norm() / kLever) / kDegree;
  fitted.overlap_before = problem.overlap(Motion4::Zero()).most;
  fitted.overlap_after = fit.overlap.most;
  fitted.colliding_before = problem.colliding(Motion4::Zero());
  fitted.colliding_after = problem.colliding(fit.motion);
  progress.update("fit joint", 1);
  return fitted;
}

// Moves the head of a bone. If the parent's tail coincided with the head, moves the tail as well.
void move_head(Armature& armature, int bone, const glm::dvec3& head) {
  constexpr double kMet = 0.1;  // distance below which a head and a tail coincide, mm
  const int parent = armature.bones[bone].parent;
  if (parent >= 0 && glm::length(armature.bones[parent].tail - armature.bones[bone].head) < kMet)
    armature.bones[parent].tail = head;
  armature.bones[bone].head = head;
}
}  // namespace

FittedJoint fit_joint(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, int bone, const FitJoint& settings, Progress& progress) {
  const std::string& name = armature.bones[bone].name;
  const bool range_is_right = settings.minimum_degrees <= settings.maximum_degrees &&
                              settings.minimum_degrees >= -180 && settings.maximum_degrees <= 180;
  if (!range_is_right)
    throw Error("the range of a joint must be two angles within -180 to 180 degrees, the smaller first", name,
                "give for example --range 0,90");
  const Axis axis{armature.bones[bone].head, flex_axis(armature, bone)};
  const Sides sides = split_sides(volume, tissue, parts, armature, bone, settings.reach_mm);
  if (sides.fixed.empty() || sides.turning.empty())
    throw Error("there is no bone tissue on one side of the joint", name,
                "fit a joint between two bones, or name the bone labels with --bones");

  const AxisFit fit = fit_axis(volume, tissue, parts, sides, axis, settings, progress);
  FittedJoint fitted{armature,          fit.moved_mm,         fit.turned_degrees, fit.overlap_before,
                     fit.overlap_after, fit.colliding_before, fit.colliding_after};
  move_head(fitted.armature, bone, fit.axis.place);
  fitted.armature.bones[bone].limits = {.type = JointLimits::Type::Hinge,
                                        .axis = fit.axis.direction,
                                        .minimum = settings.minimum_degrees * kDegree,
                                        .maximum = settings.maximum_degrees * kDegree};
  return fitted;
}

FittedPose fit_joints(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, const Pose& pose, Progress& progress) {
  constexpr double kLeast = 5 * kDegree;
  FittedPose fitted{armature, pose, {}, {}};
  for (int bone = 0; bone < std::ssize(armature.bones); ++bone) {
    glm::dquat turn = pose.rotation[bone];
    if (turn.w < 0) turn = -turn;
    const double angle = 2 * std::acos(std::min(1.0, turn.w));
    if (angle <= kLeast || armature.bones[bone].parent < 0) continue;
    const FitJoint settings{.minimum_degrees = 0, .maximum_degrees = angle / kDegree};
    const Sides sides = split_sides(volume, tissue, parts, armature, bone, settings.reach_mm);
    if (sides.fixed.empty() || sides.turning.empty()) continue;

    const Axis axis{fitted.armature.bones[bone].head, glm::axis(turn)};
    const AxisFit fit = fit_axis(volume, tissue, parts, sides, axis, settings, progress);
    if (fit.overlap_before == 0 && fit.moved_mm == 0) continue;
    move_head(fitted.armature, bone, fit.axis.place);
    fitted.pose.rotation[bone] = glm::angleAxis(angle, fit.axis.direction);
    JointLimits& limits = fitted.armature.bones[bone].limits;
    if (limits.type == JointLimits::Type::Hinge)
      limits.axis = glm::dot(limits.axis, axis.direction) < 0 ? -fit.axis.direction : fit.axis.direction;
    fitted.joints.push_back(
        {armature.bones[bone].name, fit.moved_mm, fit.turned_degrees, fit.overlap_before, fit.overlap_after});
    if (fit.overlap_after)
      fitted.warnings.push_back("joint " + armature.bones[bone].name + ": " + std::to_string(fit.overlap_after) +
                                " bone voxels still collide after fitting its axis");
  }
  return fitted;
}

}  // namespace limber
