// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/plants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/motion/body_frame.h"
#include "core/motion/limb_bend.h"
#include "core/motion/posed_rig.h"
#include "core/rig/joint_names.h"

namespace limber {

namespace {

constexpr int kLongestEase = 2000;  // an ease of more frames is cut to this number
// A limb is stretched at most to this share of its length, so that its knee or elbow stays slightly bent and the
// direction of the bend is defined.
constexpr double kStretch = 0.999;
// Largest distance that a body sinks so that a foot reaches its position, as a share of the leg's length. If that is
// not enough, the foot stays above the position.
constexpr double kDeepest = 0.15;

glm::dvec3 joint_of(const PosedRig& rig, const PlantedLimb& limb) {
  return limb.end >= 0 ? rig.head(limb.end) : rig.tail(limb.lower);
}
glm::dvec3 tip_of(const PosedRig& rig, const PlantedLimb& limb) {
  return limb.end >= 0 ? rig.tail(limb.end) : rig.tail(limb.lower);
}
glm::dvec3 point_of(const PosedRig& rig, const PlantedLimb& limb, PlantPoint point) {
  return point == PlantPoint::Joint ? joint_of(rig, limb) : tip_of(rig, limb);
}

// The lengths of a limb's two long bones, measured from joint to joint, mm.
struct Lengths {
  double upper, lower;
  double both() const { return upper + lower; }
};
Lengths lengths_of(const PlantedLimb& limb, const Armature& armature) {
  const glm::dvec3 middle = armature.bones[limb.lower].head;
  const glm::dvec3 end = limb.end >= 0 ? armature.bones[limb.end].head : armature.bones[limb.lower].tail;
  return {glm::distance(armature.bones[limb.upper].head, middle), glm::distance(middle, end)};
}

// Bends and turns the limb's two long bones so that the ankle or wrist comes to `target`, or as near to it as it can.
void reach_with(PosedRig& rig, const PlantedLimb& limb, const Armature& armature, const glm::dvec3& target) {
  constexpr double kOfHinge = 0.1;  // weight of the hinge's axis; the weight of the bent limb's axis is at most 1
  const Lengths length = lengths_of(limb, armature);
  const glm::dvec3 root = rig.head(limb.upper), upper = rig.head(limb.lower) - root,
                   lower = joint_of(rig, limb) - rig.head(limb.lower);
  const double wanted =
      std::clamp(glm::distance(root, target), std::abs(length.upper - length.lower), kStretch * length.both());
  // The axis is the one about which the limb is already bent, with the sign of the hinge. If the limb is nearly
  // straight, or is bent the wrong way, its plane is arbitrary, and the hinge gives the axis.
  const glm::dvec3 hinge = rig.turn(limb.upper) * limb.hinge;
  const glm::dvec3 bent = glm::cross(upper, lower) / (length.upper * length.lower);
  const double along = glm::dot(bent, hinge);
  const glm::dvec3 axis = glm::normalize(bent + (kOfHinge + std::max(0.0, -2 * along)) * hinge);
  rig.turn_by(limb.lower, glm::angleAxis(bend_for(upper, lower, axis, wanted), axis));
  rig.turn_by(limb.upper, shortest_turn(joint_of(rig, limb) - root, target - root));
}

// Returns the axis about which a limb bends at rest. It is the axis of the hinge limits of the limb's knee or elbow or,
// without these limits, the axis about which a knee bends backwards and an elbow forwards.
glm::dvec3 hinge_of(const PlantedLimb& limb, const Armature& armature, const glm::dvec3& back) {
  const JointLimits& limits = armature.bones[limb.lower].limits;
  if (limits.type == JointLimits::Type::Hinge && glm::length(limits.axis) > 0) return glm::normalize(limits.axis);
  const glm::dvec3 along = armature.bones[limb.lower].tail - armature.bones[limb.upper].head;
  for (const glm::dvec3& towards : {limb.is_leg ? back : -back, glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)})
    if (const glm::dvec3 axis = glm::cross(along, towards); glm::length(axis) > 1e-3 * glm::length(along))
      return glm::normalize(axis);
  return {1, 0, 0};
}

// Returns the weight of a plant at a frame: 1 in its own frames, falling smoothly to 0 within `ease` frames outside.
double share_of(const Plant& plant, int frame, int ease) {
  const int beyond = std::max({plant.first - frame, frame - plant.last, 0});
  const double t = std::max(0.0, 1 - double(beyond) / (ease + 1));
  return t * t * (3 - 2 * t);
}

// The combined effect of all plants of one point of a limb in a frame.
struct Pull {
  double share = 0;
  glm::dvec3 shift{0};  // displacement of the point, mm; already multiplied by the share
};

class Planter {
 public:
  Planter(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses,
          const std::vector<Plant>& plants, int ease, Progress& progress)
      : armature_(armature),
        limbs_(limbs),
        plants_(plants),
        ease_(ease),
        tracks_(limb_tracks(armature, limbs, poses, progress)) {}

  // Returns how far the body should move in a frame, mm: the weighted mean of the displacements of its planted feet. If
  // the body moves with its feet, the legs change their shape less.
  glm::dvec3 carrying(const Pose& pose, int frame) const {
    // The mean also contains a displacement of zero with this weight, so that one planted foot does not move the body
    // fully.
    constexpr double kOfFree = 0.1;
    const PosedRig rig(armature_, pose);
    glm::dvec3 sum(0);
    double weights = kOfFree;
    for (std::size_t l = 0; l < limbs_.size(); ++l) {
      if (!limbs_[l].is_leg || !is_pulled(l, frame)) continue;
      const double share =
          std::max(pull_of(rig, l, PlantPoint::Joint, frame).share, pull_of(rig, l, PlantPoint::Tip, frame).share);
      // The displacement of a plant that eases in or out is already multiplied by its share. The division by `share`
      // reverses this.
      sum += share * (target_of(rig, l, frame) - joint_of(rig, limbs_[l])) / std::max(share, 0.05);
      weights += share;
    }
    return sum / std::max(weights, 1.0);
  }
  // Returns how far the body must sink in a frame so that its legs reach their targets, mm.
  double sinking(const Pose& pose, int frame) const {
    const PosedRig rig(armature_, pose);
    double most = 0;
    for (std::size_t l = 0; l < limbs_.size(); ++l) {
      if (!limbs_[l].is_leg || !is_pulled(l, frame)) continue;
      const glm::dvec3 root = rig.head(limbs_[l].upper), target = target_of(rig, l, frame);
      const double length = lengths_of(limbs_[l], armature_).both(), reach = kStretch * length;
      const double aside = glm::length(glm::dvec2(target - root));
      const double up = aside < reach ? std::sqrt(reach * reach - aside * aside) : 0;
      most = std::max(most, std::min(root.z - target.z - up, kDeepest * length));
    }
    return most;
  }

  Pose plant(const Pose& pose, int frame) const {
    PosedRig rig(armature_, pose);
    for (std::size_t l = 0; l < limbs_.size(); ++l) {
      if (!is_pulled(l, frame)) continue;
      const PlantedLimb& limb = limbs_[l];
      const glm::dvec3 target = target_of(rig, l, frame), tip = tip_of(rig, limb);
      const Pull pull = pull_of(rig, l, PlantPoint::Tip, frame);
      const glm::dquat direction = limb.end >= 0 ? rig.turn(limb.end) : glm::dquat(1, 0, 0, 0);
      const glm::dvec3 moved = target - joint_of(rig, limb);
      const Pose before = rig.pose();
      const double share = std::max(pull.share, pull_of(rig, l, PlantPoint::Joint, frame).share);
      reach_with(rig, limb, armature_, target);
      if (limb.end >= 0) {
        rig.turn_to(limb.end, direction);
        const glm::dvec3 wanted = tip + pull.shift + (1 - pull.share) * moved;
        rig.turn_by(limb.end, shortest_turn(tip_of(rig, limb) - rig.head(limb.end), wanted - rig.head(limb.end)));
      }
      if (share >= 1) continue;
      // While a plant eases in or out, the change of the limb's bending plane is eased as well, not only its position.
      for (const int bone : {limb.upper, limb.lower, limb.end})
        if (bone >= 0) rig.mix_back(bone, before, share);
    }
    return rig.pose();
  }

 private:
  bool is_pulled(std::size_t limb, int frame) const {
    return std::any_of(plants_.begin(), plants_.end(), [&](const Plant& plant) {
      return plant.limb == static_cast<int>(limb) && share_of(plant, frame, ease_) > 0;
    });
  }
  // Returns the position that a plant wants for its point in a frame. In a frame outside of the plant, this is the
  // point's original position, shifted by as much as the plant shifts the point in its nearest frame, so that a foot
  // that comes down is not pulled to the ground early.
  glm::dvec3 goal_of(const Plant& plant, int frame) const {
    const std::vector<glm::dvec3>& track = tracks_[plant.limb][static_cast<int>(plant.point)];
    return plant.place + track[frame] - track[std::clamp(frame, plant.first, plant.last)];
  }
  // Returns the combined displacement that the plants want for one point of a limb. If the limb has no foot or hand,
  // its joint and its tip are the same point.
  Pull pull_of(const PosedRig& rig, std::size_t limb, PlantPoint point, int frame) const {
    const glm::dvec3 own = point_of(rig, limbs_[limb], point);
    Pull pull;
    // In frames between two plants of one point that closely follow one another, both plants have an effect, the nearer
    // one with more weight. Within a plant's own frames, only this plant has an effect.
    double weights = 0, free = 1;
    for (const Plant& plant : plants_) {
      if (plant.limb != static_cast<int>(limb) || plant.point != point) continue;
      const double share = share_of(plant, frame, ease_), weight = share / (1 - share + 1e-12);
      pull.shift += weight * (goal_of(plant, frame) - own);
      weights += weight;
      free *= 1 - share;
    }
    if (weights == 0) return pull;
    pull.share = 1 - free;
    pull.shift *= pull.share / weights;
    return pull;
  }
  // Returns the target of the limb's joint. It follows the joint's own plant; where this has less than full weight, the
  // joint moves along with the tip.
  glm::dvec3 target_of(const PosedRig& rig, std::size_t limb, int frame) const {
    const Pull joint = pull_of(rig, limb, PlantPoint::Joint, frame), tip = pull_of(rig, limb, PlantPoint::Tip, frame);
    const glm::dvec3 own = joint_of(rig, limbs_[limb]), target = own + joint.shift + (1 - joint.share) * tip.shift;
    if (limbs_[limb].end < 0) return target;
    // While the tip is planted and the joint's plant eases in or out, the joint moves on a sphere about the tip.
    const Bone& end = armature_.bones[limbs_[limb].end];
    const double of_tip = tip.share * (1 - joint.share), of_joint = joint.share * (1 - tip.share);
    const glm::dvec3 held = tip_of(rig, limbs_[limb]) + tip.shift + (1 - tip.share) * (target - own);
    if (of_tip == 0 || glm::distance(held, target) == 0) return target;
    const glm::dvec3 on_sphere = held + glm::normalize(target - held) * glm::distance(end.head, end.tail);
    return glm::mix(target, on_sphere, of_tip / (of_tip + of_joint));
  }

  const Armature& armature_;
  const std::vector<PlantedLimb>& limbs_;
  const std::vector<Plant>& plants_;
  const int ease_;
  const LimbTracks tracks_;  // positions of joints and tips in the poses that were given
};

// Returns the values smoothed over the frames up to `reach` before and after, with weights that fall linearly.
std::vector<glm::dvec3> averaged(const std::vector<glm::dvec3>& values, int reach) {
  const int count = static_cast<int>(values.size());
  std::vector<glm::dvec3> result(values.size());
  for (int f = 0; f < count; ++f) {
    double weights = 0;
    for (int g = std::max(0, f - reach); g <= std::min(count - 1, f + reach); ++g) {
      const double weight = reach + 1 - std::abs(g - f);
      result[f] += weight * values[g];
      weights += weight;
    }
    result[f] /= weights;
  }
  return result;
}

// Returns a smooth curve that is nowhere below the given values: the largest value within `reach` frames, then smoothed
// over as many frames.
std::vector<double> smooth_above(const std::vector<double>& values, int reach) {
  const int count = static_cast<int>(values.size());
  std::vector<double> most(count), smooth(count);
  for (int f = 0; f < count; ++f)
    for (int g = std::max(0, f - reach); g <= std::min(count - 1, f + reach); ++g)
      most[f] = std::max(most[f], values[g]);
  for (int f = 0; f < count; ++f) {
    double sum = 0, weights = 0;
    for (int g = f - reach; g <= f + reach; ++g) {
      const double weight = reach + 1 - std::abs(g - f);
      sum += weight * most[std::clamp(g, 0, count - 1)];
      weights += weight;
    }
    smooth[f] = sum / weights;
  }
  return smooth;
}

}  // namespace

std::vector<PlantedLimb> planted_limbs(const Armature& armature) {
  const Skeleton skeleton = skeleton_of(armature);
  const auto bone_of = [&](BodyPart part, BodySide side) {
    const auto found = skeleton.joint.find({part, side, 0});
    return found == skeleton.joint.end() ? -1 : found->second;
  };
  const auto axes = body_axes(skeleton, BodyPart::Thigh);
  std::vector<PlantedLimb> limbs;
  for (const bool is_leg : {true, false})
    for (const BodySide side : {BodySide::Left, BodySide::Right, BodySide::Middle}) {
      PlantedLimb limb;
      const char* of_side = side == BodySide::Left ? "left " : side == BodySide::Right ? "right " : "";
      limb.name = std::string(of_side) + (is_leg ? "foot" : "hand");
      limb.upper = bone_of(is_leg ? BodyPart::Thigh : BodyPart::UpperArm, side);
      limb.lower = bone_of(is_leg ? BodyPart::Shank : BodyPart::Forearm, side);
      limb.end = bone_of(is_leg ? BodyPart::Foot : BodyPart::Hand, side);
      limb.is_leg = is_leg;
      if (limb.upper < 0 || limb.lower < 0) continue;
      const auto hangs_on = [&](int bone, int above) {
        while (bone >= 0 && bone != above) bone = armature.bones[bone].parent;
        return bone >= 0;
      };
      if (!hangs_on(limb.lower, limb.upper)) continue;
      // If a foot is not a descendant of the shank (as with control bones for inverse kinematics), turning the leg does
      // not move the foot.
      if (limb.end >= 0 && (!hangs_on(limb.end, limb.lower) ||
                            !(glm::distance(armature.bones[limb.end].head, armature.bones[limb.end].tail) > 0)))
        limb.end = -1;
      const Lengths length = lengths_of(limb, armature);
      if (!(length.upper > 0 && length.lower > 0)) continue;
      limb.hinge = hinge_of(limb, armature, axes ? (*axes)[1] : glm::dvec3(0, 1, 0));
      limbs.push_back(std::move(limb));
    }
  return limbs;
}

glm::dvec3 place_of(const PlantedLimb& limb, PlantPoint point, const Armature& armature, const Pose& pose) {
  return point_of(PosedRig(armature, pose), limb, point);
}

LimbTracks limb_tracks(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses,
                       Progress& progress) {
  LimbTracks tracks(limbs.size());
  for (const Pose& pose : poses) {
    if (progress.cancelled()) throw Cancelled();
    const PosedRig rig(armature, pose);
    for (std::size_t l = 0; l < limbs.size(); ++l)
      for (const PlantPoint point : {PlantPoint::Joint, PlantPoint::Tip})
        tracks[l][static_cast<int>(point)].push_back(point_of(rig, limbs[l], point));
  }
  return tracks;
}

std::vector<Plant> without_held(const std::vector<Plant>& plants, const Plant& hold, int ease) {
  const int from = hold.first - ease, to = hold.last + ease;
  std::vector<Plant> left;
  for (const Plant& plant : plants) {
    if (plant.limb != hold.limb || plant.last < from || plant.first > to) {
      left.push_back(plant);
      continue;
    }
    for (const auto& [first, last] : {std::pair{plant.first, from - 1}, {to + 1, plant.last}})
      if (first < last) left.push_back({plant.limb, plant.point, first, last, plant.place});
  }
  return left;
}

std::vector<Pose> planted(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                          const std::vector<Pose>& poses, const std::vector<Plant>& plants, int ease,
                          Progress& progress) {
  const int last = static_cast<int>(poses.size()) - 1;
  for (const Plant& plant : plants) {
    if (plant.limb < 0 || plant.limb >= std::ssize(limbs))
      throw Error("a plant does not name a limb of the rig", "planting", "name a hand or foot that the rig has");
    if (plant.first < 0 || plant.last < plant.first || plant.last > last)
      throw Error(
          "the motion does not have these frames",
          limbs[plant.limb].name + ", frames " + std::to_string(plant.first) + " to " + std::to_string(plant.last),
          "choose frames from 0 to " + std::to_string(last));
  }
  for (std::size_t i = 0; i < plants.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Plant &a = plants[i], &b = plants[k];
      if (a.limb == b.limb && a.point == b.point && a.first <= b.last && b.first <= a.last)
        throw Error("one limb cannot be held at two places at once",
                    limbs[a.limb].name + ", frames " + std::to_string(std::max(a.first, b.first)) + " to " +
                        std::to_string(std::min(a.last, b.last)),
                    "choose frames that do not overlap");
    }
  ease = std::clamp(ease, 0, kLongestEase);
  const Planter planter(armature, limbs, poses, plants, ease, progress);
  std::vector<Pose> result = poses;
  std::vector<glm::dvec3> carrying(poses.size());
  for (int f = 0; f <= last; ++f) {
    if (progress.cancelled()) throw Cancelled();
    carrying[f] = planter.carrying(poses[f], f);
  }
  carrying = averaged(carrying, ease);
  for (int f = 0; f <= last; ++f) result[f].root_translation += carrying[f];
  std::vector<double> sinking(poses.size());
  for (int f = 0; f <= last; ++f) {
    if (progress.cancelled()) throw Cancelled();
    sinking[f] = planter.sinking(result[f], f);
  }
  sinking = smooth_above(sinking, ease);
  for (int f = 0; f <= last; ++f) {
    progress.update("planting", double(f) / double(poses.size()));
    result[f].root_translation.z -= sinking[f];
    result[f] = planter.plant(result[f], f);
  }
  return result;
}

PlantError error_of(const Plant& plant, const Armature& armature, const std::vector<PlantedLimb>& limbs,
                    const std::vector<Pose>& poses) {
  PlantError error;
  glm::dvec3 first(0);
  for (int f = plant.first; f <= plant.last; ++f) {
    const glm::dvec3 place = place_of(limbs[plant.limb], plant.point, armature, poses[f]);
    if (f == plant.first) first = place;
    const double off = glm::distance(place, plant.place), slid = glm::distance(glm::dvec2(place), glm::dvec2(first));
    if (!(off <= error.from_place)) error.from_place = off;
    if (!(slid <= error.slide)) error.slide = slid;
  }
  return error;
}

}  // namespace limber
