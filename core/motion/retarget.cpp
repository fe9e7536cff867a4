// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/retarget.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/motion/body_frame.h"
#include "core/motion/same_skeleton.h"
#include "core/rig/mirror.h"

namespace limber {

namespace {
constexpr BodySide kSides[] = {BodySide::Left, BodySide::Right};
// Largest correction, radians, of the rotation of a thigh, shank or foot that keeps the foot from sliding (1.95
// degrees).
constexpr double kMostTurn = 0.034;

bool hangs_from(const Armature& armature, int bone, int ancestor) {
  while (bone > ancestor) bone = armature.bones[bone].parent;
  return bone == ancestor;
}

glm::dquat turn_by(const glm::dvec3& rotation) {
  const double angle = glm::length(rotation);
  return angle > 1e-12 ? glm::angleAxis(angle, rotation / angle) : glm::dquat(1, 0, 0, 0);
}

// Returns the rotation that moves the end of the vector `way` horizontally by `aside`, mm. Its angle is at most
// kMostTurn.
glm::dquat turn_aside(const glm::dvec3& way, const glm::dvec2& aside) {
  const glm::dvec2 flat = glm::dvec2(way) + aside;
  const double squared_height = glm::dot(way, way) - glm::dot(flat, flat);
  const glm::dvec3 wanted(flat, squared_height > 0 ? std::copysign(std::sqrt(squared_height), way.z) : way.z);
  const glm::dquat turn = shortest_turn(way, wanted);
  return glm::angle(turn) > kMostTurn ? glm::angleAxis(kMostTurn, glm::axis(turn)) : turn;
}

bool is_trunk(BodyPart part) {
  return part == BodyPart::Pelvis || part == BodyPart::Spine || part == BodyPart::Neck || part == BodyPart::Head;
}

// ---- rotations of the rig's bones at the reference frame

class Alignment {
 public:
  // Computes for each bone of the rig the rotation from the rig's rest pose to the pose of the source skeleton. Callers
  // use only the rotations of bones that are matched to a joint.
  //   stances   the kinds of rest pose that the user named for rig and source
  //   rebuilt   joints of the source that were turned into the named rest pose. The fingers below them no longer show
  //             where the palm faces.
  Alignment(const Skeleton& rig, const Skeleton& source, const std::vector<int>& joint_of_bone, bool source_at_rest,
            const RestStances& stances, const std::vector<int>& rebuilt)
      : rig_(rig),
        source_(source),
        joint_(joint_of_bone),
        stances_(stances),
        rebuilt_(rebuilt),
        turn_(joint_of_bone.size(), glm::dquat(1, 0, 0, 0)) {
    hips_ = body_turn(BodyPart::Thigh, source_at_rest);
    shoulders_ = body_turn(BodyPart::UpperArm, source_at_rest);
    if (!hips_) hips_ = shoulders_;
    if (!shoulders_) shoulders_ = hips_;
    for (size_t bone = 0; bone < joint_.size(); ++bone)
      turn_[bone] = joint_[bone] >= 0 ? turn_of(static_cast<int>(bone)) : above(static_cast<int>(bone));
    for (BodySide side : {BodySide::Middle, BodySide::Left, BodySide::Right}) turn_palm(side);
  }

  const std::vector<glm::dquat>& turns() const { return turn_; }

 private:
  // Returns the rotation of the whole body from the rig to the source. For a source in an upright rest pose, this is
  // only a rotation about the vertical: a small lean of its trunk line comes from where the skeleton has its joints,
  // not from how the body stands.
  std::optional<glm::dquat> body_turn(BodyPart part, bool source_at_rest) const {
    const auto from = body_axes(rig_, part), to = body_axes(source_, part);
    if (!from || !to) return std::nullopt;
    const glm::dquat full = glm::normalize(glm::quat_cast(*to * glm::transpose(*from)));
    if (!source_at_rest || angle_between((*to)[2], kUp) > 0.35) return full;
    return heading_turn((*from)[0], (*to)[0]);
  }

  static glm::dquat heading_turn(const glm::dvec3& from, const glm::dvec3& to) {
    return glm::angleAxis(std::atan2(to.y, to.x) - std::atan2(from.y, from.x), kUp);
  }

  glm::dquat above(int bone) const {
    const int parent = rig_.parents[bone];
    return parent >= 0 ? turn_[parent] : hips_.value_or(glm::dquat(1, 0, 0, 0));
  }

  glm::dquat turn_of(int bone) const {
    const auto& role = rig_.role[bone];
    if (role && is_trunk(role->part)) return trunk_turn(*role);
    const bool keeps_shape = role && (role->part == BodyPart::Clavicle || role->part == BodyPart::HipLink);
    if (role && role->part == BodyPart::Clavicle && shoulders_) return *shoulders_;
    if (keeps_shape || (role && role->part == BodyPart::Toes)) return above(bone);

    const glm::dvec3 here = direction_of(rig_, bone), there = direction_of(source_, joint_[bone]);
    if (glm::length(here) < 1e-9 || glm::length(there) < 1e-9) return above(bone);
    if (role && role->part == BodyPart::Foot) {
      auto pitch = [](const glm::dvec3& d) { return std::atan2(d.z, std::hypot(d.x, d.y)); };
      // If both feet are flat on the ground, the bone takes only the heading of the source's foot: their pitches differ
      // only because the ankles have different heights above the soles. Otherwise the bone takes the full direction of
      // that foot.
      if (std::abs(pitch(here) - pitch(there)) < 0.6 && std::abs(pitch(there)) < 1 && std::abs(pitch(here)) < 1)
        return heading_turn(here, there);
    }
    const glm::dquat carried = above(bone);
    return glm::normalize(shortest_turn(carried * here, there) * carried);
  }

  glm::dquat trunk_turn(const JointRole& role) const {
    if (!hips_) return {1, 0, 0, 0};
    if (role.part == BodyPart::Pelvis) return *hips_;
    if (role.part != BodyPart::Spine) return *shoulders_;
    int bones = 0;
    while (rig_.joint.contains({BodyPart::Spine, BodySide::Middle, bones})) ++bones;
    return glm::normalize(glm::slerp(*hips_, *shoulders_, double(role.index + 1) / bones));
  }

  // Turns the hand so that its palm faces the same way as the source's palm. The forearm takes half of the twist.
  void turn_palm(BodySide side) {
    const auto hand = rig_.joint.find({BodyPart::Hand, side});
    if (hand == rig_.joint.end() || joint_[hand->second] < 0) return;
    const int bone = hand->second, source = joint_[bone];
    const auto [here, there] = palm_lines(side, bone, source);
    if (!here || !there) return;
    const auto from = axes_of(turn_[bone] * direction_of(rig_, bone), turn_[bone] * *here),
               to = axes_of(direction_of(source_, source), *there);
    if (!from || !to) return;
    const glm::dquat before = turn_[bone];
    turn_[bone] = glm::normalize(glm::quat_cast(*to * glm::transpose(*from)) * before);

    const int forearm = rig_.parents[bone];
    if (forearm >= 0 && joint_[forearm] >= 0 && rig_.role[forearm] && rig_.role[forearm]->part == BodyPart::Forearm) {
      const glm::dvec3 along = glm::normalize(turn_[forearm] * direction_of(rig_, forearm));
      const glm::dquat more = turn_[bone] * glm::conjugate(before);
      const double twist = std::remainder(2 * std::atan2(glm::dot(glm::dvec3(more.x, more.y, more.z), along), more.w),
                                          2 * std::numbers::pi);
      turn_[forearm] = glm::normalize(glm::angleAxis(twist / 2, along) * turn_[forearm]);
    }
    // Computes the rotations of the hand's descendants again, since they depend on the hand's rotation.
    for (size_t below = bone + 1; below < joint_.size(); ++below) {
      if (!hangs_from(static_cast<int>(below), bone)) continue;
      turn_[below] = joint_[below] >= 0 ? turn_of(static_cast<int>(below)) : above(static_cast<int>(below));
    }
  }

  bool hangs_from(int bone, int ancestor) const {
    while (bone > ancestor) bone = rig_.parents[bone];
    return bone == ancestor;
  }

  // Returns the directions across the palm of the rig and of the source, from the thumb's side to the little finger. If
  // both skeletons have knuckles, both directions come from the knuckles; else, if both have a thumb, from the thumb.
  // Otherwise each direction comes from the skeleton's own fingers, or else from the stance that the user named.
  std::pair<std::optional<glm::dvec3>, std::optional<glm::dvec3>> palm_lines(BodySide side, int hand,
                                                                             int source_hand) const {
    const auto& role = source_.role[source_hand];
    const BodySide source_side = role ? role->side : side;
    const bool tells = std::find(rebuilt_.begin(), rebuilt_.end(), source_hand) == rebuilt_.end();
    for (const auto line : {knuckles, thumb})
      if (const auto here = line(rig_, side), there = line(source_, source_side); here && there && tells)
        return {here, there};
    const auto seen_or_said = [&](const Skeleton& skeleton, RestStance stance, BodySide of, int joint,
                                  bool sees) -> std::optional<glm::dvec3> {
      for (const auto line : {knuckles, thumb})
        if (const auto seen = line(skeleton, of); seen && sees) return seen;
      const glm::dmat3 body = axes_of_body(skeleton);
      const auto said = palm_in(stance, of == BodySide::Middle ? source_side : of,
                                glm::transpose(body) * direction_of(skeleton, joint));
      return said ? std::optional(body * *said) : std::nullopt;
    };
    return {seen_or_said(rig_, stances_.rig, side, hand, true),
            seen_or_said(source_, stances_.source, source_side, source_hand, tells)};
  }

  static std::optional<glm::dvec3> knuckles(const Skeleton& skeleton, BodySide of) {
    const auto index = skeleton.place_of(BodyPart::Index, of, 1), little = skeleton.place_of(BodyPart::Little, of, 1);
    return index && little ? std::optional(*little - *index) : std::nullopt;
  }
  static std::optional<glm::dvec3> thumb(const Skeleton& skeleton, BodySide of) {
    for (int segment : {3, 2, 1}) {
      const auto found = skeleton.joint.find({BodyPart::Thumb, of, segment});
      const auto hand = skeleton.place_of(BodyPart::Hand, of);
      if (found != skeleton.joint.end() && hand) return *hand - skeleton.tip[found->second];
    }
    return std::nullopt;
  }

  const Skeleton& rig_;
  const Skeleton& source_;
  const std::vector<int>& joint_;
  const RestStances stances_;
  const std::vector<int>& rebuilt_;
  std::vector<glm::dquat> turn_;
  std::optional<glm::dquat> hips_, shoulders_;
};

// ---- matching

// Returns the side of a rig of a single hand. In a right hand, three directions form a right-handed system: along the
// hand, from the index to the little finger, and to where the fingers curl. Returns Right if the rig lacks the fingers
// that show these directions.
BodySide side_of_single(const Skeleton& rig) {
  auto of = [&](BodyPart finger, int segment) { return rig.place_of(finger, BodySide::Middle, segment); };
  const auto index = of(BodyPart::Index, 1), little = of(BodyPart::Little, 1), knuckle = of(BodyPart::Middle, 1),
             bend = of(BodyPart::Middle, 2);
  const auto last = rig.joint.find({BodyPart::Middle, BodySide::Middle, 3});
  if (!index || !little || !knuckle || !bend || last == rig.joint.end()) return BodySide::Right;
  const glm::dvec3 along = *bend - *knuckle, end = rig.tip[last->second] - *bend;
  const glm::dvec3 curl = end - along * (glm::dot(end, along) / std::max(glm::dot(along, along), 1e-300));
  return glm::dot(glm::cross(along, *little - *index), curl) >= 0 ? BodySide::Right : BodySide::Left;
}

std::vector<int> chain_of(const Skeleton& skeleton, BodyPart part) {
  std::vector<int> chain;
  for (int index = 0;; ++index) {
    const auto found = skeleton.joint.find({part, BodySide::Middle, index});
    if (found == skeleton.joint.end()) return chain;
    chain.push_back(found->second);
  }
}

// Matches the bones of a chain, such as the spine, to the joints of the same names. If no names agree, spreads the
// matches evenly along the chain, with the last bone at the last joint.
void match_chain(const std::vector<int>& bones, const std::vector<int>& joints, const Armature& armature,
                 const Motion& motion, const std::function<void(int, int)>& match) {
  bool any = false;
  for (int bone : bones)
    for (int joint : joints)
      if (plain_name(armature.bones[bone].name) == plain_name(motion.joints[joint].name))
        match(bone, joint), any = true;
  if (any || bones.empty() || joints.empty()) return;
  const size_t n = bones.size(), m = joints.size();
  if (n <= m)
    for (size_t k = 0; k < n; ++k) match(bones[k], joints[((k + 1) * m + n - 1) / n - 1]);
  else
    for (size_t i = 0; i < m; ++i) match(bones[((i + 1) * n + m - 1) / m - 1], joints[i]);
}

std::string names_of(const Motion& motion) {
  std::string names;
  for (size_t i = 0; i < motion.joints.size() && i < 6; ++i) names += (i ? ", " : "") + motion.joints[i].name;
  return names + (motion.joints.size() > 6 ? ", ..." : "");
}

double leg_length(const Skeleton& skeleton, BodyPart upper, BodyPart lower, BodyPart end) {
  double sum = 0;
  int count = 0;
  for (BodySide side : kSides) {
    const auto a = skeleton.place_of(upper, side), b = skeleton.place_of(lower, side), c = skeleton.place_of(end, side);
    if (a && b && c) sum += glm::length(*b - *a) + glm::length(*c - *b), ++count;
  }
  return count ? sum / count : 0;
}

// Returns the scale from source to rig, mm per unit of the source. It is the ratio of their leg lengths. Skeletons
// without legs are compared by their arms, those without arms by their trunks.
double scale_between(const Skeleton& rig, const Skeleton& source) {
  auto length = [](const Skeleton& skeleton, int way) {
    if (way == 0) return leg_length(skeleton, BodyPart::Thigh, BodyPart::Shank, BodyPart::Foot);
    if (way == 1) return leg_length(skeleton, BodyPart::UpperArm, BodyPart::Forearm, BodyPart::Hand);
    const auto line = trunk_line(skeleton);
    return line ? glm::length(*line) : 0.0;
  };
  for (int way : {0, 1, 2}) {
    const double here = length(rig, way), there = length(source, way);
    if (here > 1e-9 && there > 1e-9) return here / there;
  }
  return 1;
}

// Returns the rest offset of each matched bone: the constant rotation between the bone and its source joint. It is
// measured at frame `standing`, at which the source's pose corresponds to the rest pose of the rig.
std::vector<glm::dquat> offsets_between(const Motion& motion, const Skeleton& rig, Skeleton source,
                                        const std::vector<int>& joint_of_bone, int standing, const RestStances& stances,
                                        const std::vector<int>& rebuilt) {
  place_joints(source, motion, standing);
  const auto world = forward_kinematics(motion, standing);
  std::vector<glm::dquat> offsets =
      Alignment(rig, source, joint_of_bone, standing < 0 || stances.source != RestStance::AsItLies, stances, rebuilt)
          .turns();
  for (size_t b = 0; b < offsets.size(); ++b)
    if (joint_of_bone[b] >= 0)
      offsets[b] = glm::normalize(glm::conjugate(lps_from_bvh(world[joint_of_bone[b]].rotation)) * offsets[b]);
  return offsets;
}
}  // namespace

std::string RetargetMap::joint_of(const std::string& bone) const {
  const auto found = sources.find(bone);
  return found == sources.end() ? "" : found->second.joint;
}

RetargetMap match_by_names(const Motion& motion, const Armature& armature) {
  RetargetMap map;
  if (same_skeleton(motion, armature)) {
    for (const Bone& bone : armature.bones) map.sources[bone.name] = {bone.name, {}};
    return map;
  }
  const Skeleton rig = skeleton_of(armature), source = skeleton_of(motion);
  std::vector<int> joint_of(armature.bones.size(), -1);
  auto match = [&](int bone, int joint) {
    if (joint_of[bone] < 0) joint_of[bone] = joint;
  };
  for (BodyPart chain : {BodyPart::Spine, BodyPart::Neck})
    match_chain(chain_of(rig, chain), chain_of(source, chain), armature, motion, match);

  // A rig of a single limb may have no sides in its names. It then takes the motion of the left or of the right limb,
  // whichever its shape resembles.
  const bool one_limb = std::none_of(rig.joint.begin(), rig.joint.end(),
                                     [](const auto& entry) { return entry.first.side != BodySide::Middle; });
  const bool sided_source = std::any_of(source.joint.begin(), source.joint.end(),
                                        [](const auto& entry) { return entry.first.side != BodySide::Middle; });
  const BodySide only_side = side_of_single(rig);
  for (const auto& [role, bone] : rig.joint) {
    if (role.part == BodyPart::Spine || role.part == BodyPart::Neck) continue;
    JointRole wanted = role;
    if (one_limb && sided_source && role.part >= BodyPart::Clavicle) wanted.side = only_side;
    auto found = source.joint.find(wanted);
    // A metacarpal bone without a matching joint follows the source's hand joint if the rig has no hand bone.
    if (found == source.joint.end() && role.index == 0 && role.part > BodyPart::Thumb &&
        !rig.joint.contains({BodyPart::Hand, role.side}))
      found = source.joint.find({BodyPart::Hand, wanted.side});
    if (found != source.joint.end()) match(bone, found->second);
  }

  // Bones and joints whose names mean no known body part are matched where they have the same name.
  std::map<std::string, int> by_name;
  for (size_t j = 0; j < motion.joints.size(); ++j)
    if (!source.role[j]) by_name.emplace(plain_name(motion.joints[j].name), static_cast<int>(j));
  for (size_t b = 0; b < armature.bones.size(); ++b)
    if (const auto found = by_name.find(plain_name(armature.bones[b].name)); !rig.role[b] && found != by_name.end())
      match(static_cast<int>(b), found->second);

  for (size_t b = 0; b < joint_of.size(); ++b)
    if (joint_of[b] >= 0) map.sources[armature.bones[b].name] = {motion.joints[joint_of[b]].name, {}};
  if (map.sources.empty())
    throw Error("no joint name of the motion is recognised", names_of(motion),
                "write a map file and give it with --map");
  return map;
}

Retarget::Retarget(const Motion& motion, const Armature& armature, const RetargetMap& map,
                   const RetargetSettings& settings)
    : motion_(&motion),
      armature_(&armature),
      settings_(settings),
      stances_(map.stances),
      joint_of_bone_(armature.bones.size(), -1),
      rest_offset_(armature.bones.size(), glm::dquat(1, 0, 0, 0)),
      between_(armature.bones.size()) {
  if (motion.frame_count == 0) throw Error("the motion has no frames", names_of(motion), "use a BVH with frames");
  std::map<std::string, int> joints;
  for (size_t j = 0; j < motion.joints.size(); ++j) joints.emplace(motion.joints[j].name, static_cast<int>(j));
  for (const auto& [bone, source] : map.sources) {
    const auto joint = joints.find(source.joint);
    if (joint == joints.end())
      throw Error("the motion has no such joint", source.joint, "use one of its joints (" + names_of(motion) + ")");
    joint_of_bone_[require_bone(armature, bone)] = joint->second;
  }

  // The constant rotations between joints and bones (rest offsets) are measured at the frame at which the source
  // stands.
  Skeleton rig = skeleton_of(armature), source = skeleton_of(motion);
  // A bone whose name means no known body part takes the body part of its joint.
  for (size_t b = 0; b < joint_of_bone_.size(); ++b) {
    const auto role = joint_of_bone_[b] >= 0 ? source.role[joint_of_bone_[b]] : std::nullopt;
    if (rig.role[b] || !role) continue;
    const bool in_gap = role->part == BodyPart::Spine && role->index > 0 &&
                        !rig.joint.contains({role->part, role->side, role->index - 1});
    if (!in_gap && rig.joint.emplace(*role, static_cast<int>(b)).second) rig.role[b] = role;
  }
  const bool by_their_names =
      stances_ == RestStances{} && std::all_of(map.sources.begin(), map.sources.end(),
                                               [](const auto& pair) { return pair.first == pair.second.joint; });
  const auto same =
      by_their_names && settings.reference == Reference::Found ? same_skeleton(motion, armature) : std::nullopt;
  const bool said = stances_.source != RestStance::AsItLies;
  const int standing = settings.reference == Reference::FirstFrame                 ? 0
                       : settings.reference == Reference::RestPose || said || same ? -1
                                                                                   : standing_frame(motion, source);
  if (said) {
    Straightened straight = straightened(motion, stances_.source, standing);
    turned_joints_ = std::move(straight.turned);
    if (!turned_joints_.empty())
      straight_ = std::make_shared<const Motion>(std::move(straight.motion)), motion_ = straight_.get();
  }
  const std::vector<glm::dquat> found =
      same ? std::vector(rest_offset_.size(), glm::conjugate(same->rig_from_source))
           : offsets_between(*motion_, rig, source, joint_of_bone_, standing, stances_, turned_joints_);
  for (size_t b = 0; b < rest_offset_.size(); ++b)
    if (joint_of_bone_[b] >= 0) rest_offset_[b] = map.sources.at(armature.bones[b].name).rest_offset.value_or(found[b]);
  scale_ = settings.scale > 0 ? settings.scale : same ? same->scale : scale_between(rig, source);
  const auto first = std::find_if(joint_of_bone_.begin(), joint_of_bone_.end(), [](int joint) { return joint >= 0; });
  const bool from_rest = same && same->in_place;
  if (first != joint_of_bone_.end())
    lead_ = *first, start_ = forward_kinematics(*motion_, from_rest ? -1 : 0)[lead_].translation;

  // For each unmatched bone of the trunk, finds the nearest matched bones below and above. From each matched trunk bone
  // `top`, the loop goes from parent to parent down to the next matched bone; the bones on the way are unmatched.
  for (size_t top = 0; top < joint_of_bone_.size(); ++top) {
    if (joint_of_bone_[top] < 0 || !rig.role[top] || !is_trunk(rig.role[top]->part)) continue;
    std::vector<int> gap;
    int below = armature.bones[top].parent;
    for (; below >= 0 && joint_of_bone_[below] < 0; below = armature.bones[below].parent) gap.push_back(below);
    if (below < 0) continue;
    for (size_t k = 0; k < gap.size(); ++k)
      if (between_[gap[k]].below < 0)
        between_[gap[k]] = {below, static_cast<int>(top), double(gap.size() - k) / double(gap.size() + 1)};
  }

  for (BodySide side : kSides) {
    const auto thigh = rig.joint.find({BodyPart::Thigh, side}), foot = rig.joint.find({BodyPart::Foot, side});
    if (thigh == rig.joint.end() || foot == rig.joint.end() || joint_of_bone_[foot->second] < 0) continue;
    if (!hangs_from(armature, foot->second, thigh->second)) continue;
    const auto toes = rig.joint.find({BodyPart::Toes, side});
    const bool has_toes = toes != rig.joint.end() && joint_of_bone_[toes->second] >= 0 &&
                          armature.bones[toes->second].parent == foot->second;
    const auto shank = rig.joint.find({BodyPart::Shank, side});
    const bool has_shank =
        shank != rig.joint.end() && shank->second > thigh->second && hangs_from(armature, foot->second, shank->second);
    legs_.push_back(
        {thigh->second, has_shank ? shank->second : foot->second, foot->second, has_toes ? toes->second : -1});
  }
  if (settings.travel != Travel::Locked && !legs_.empty() && !same)
    feet_ = mend_sliding(foot_tracks(), motion.frame_time, settings.travel == Travel::Free);
}

RetargetMap Retarget::map() const {
  RetargetMap map{.stances = stances_};
  for (size_t b = 0; b < joint_of_bone_.size(); ++b)
    if (joint_of_bone_[b] >= 0)
      map.sources[armature_->bones[b].name] = {motion_->joints[joint_of_bone_[b]].name, rest_offset_[b]};
  return map;
}

Pose Retarget::at(int frame) const {
  if (frame < 0 || frame >= motion_->frame_count)
    throw Error("the motion has no frame " + std::to_string(frame), "--frame",
                "use a frame from 0 to " + std::to_string(motion_->frame_count - 1));
  Pose pose = carried_over(forward_kinematics(*motion_, frame));
  if (!feet_.travel.empty()) pose.root_translation += feet_.travel[frame];
  for (std::size_t i = 0; i < feet_.ankle_aside.size(); ++i)
    move_foot(pose, legs_[i], feet_.ankle_aside[i][frame], feet_.toes_aside[i][frame]);
  return settings_.mirror ? flipped(pose, *armature_) : pose;
}

// Returns the leg's foot bone for the ankle, and its toes bone for the toes (-1: the leg has no toes).
int Retarget::bone_of(const Leg& leg, int point) { return point == FootTrack::Toes ? leg.toes : leg.foot; }

// Computes the positions of the leg joints at every frame. To save time, only the joints and bones that the feet depend
// on are evaluated; they are few even in motions of many joints.
std::vector<FootTrack> Retarget::foot_tracks() const {
  std::vector<bool> bone_matters(armature_->bones.size(), false), joint_matters(motion_->joints.size(), false);
  const auto matters = [&](int bone) {
    for (int joint = bone < 0 ? -1 : joint_of_bone_[bone]; joint >= 0 && !joint_matters[joint];
         joint = motion_->joints[joint].parent)
      joint_matters[joint] = true;
  };
  for (int joint = lead_; joint >= 0; joint = motion_->joints[joint].parent) joint_matters[joint] = true;
  for (const Leg& leg : legs_) {
    matters(leg.foot);
    matters(leg.toes);
    for (int bone = leg.toes >= 0 ? leg.foot : armature_->bones[leg.foot].parent; bone >= 0;
         bone = armature_->bones[bone].parent) {
      bone_matters[bone] = true;
      for (const int mover : {bone, between_[bone].below, between_[bone].above}) matters(mover);
    }
  }

  const int frames = motion_->frame_count;
  const std::size_t count = legs_.size();
  std::vector<FootTrack> feet(count);
  for (std::size_t i = 0; i < count; ++i) {
    feet[i].rest_height = armature_->bones[legs_[i].foot].head.z;
    feet[i].most_turn = kMostTurn;
    feet[i].hip.resize(frames), feet[i].knee.resize(frames);
    for (const int point : {FootTrack::Ankle, FootTrack::Toes})
      if (bone_of(legs_[i], point) >= 0) feet[i].source[point].resize(frames), feet[i].body[point].resize(frames);
  }
  parallel_for(frames, 64, [&](std::int64_t begin, std::int64_t end) {
    std::vector<RigidTransform> joints(motion_->joints.size());
    std::vector<glm::dquat> turn(armature_->bones.size());
    std::vector<glm::dvec3> head(armature_->bones.size());
    for (std::int64_t frame = begin; frame < end; ++frame) {
      for (int joint = 0; joint < std::ssize(joints); ++joint)
        if (joint_matters[joint]) place_joint(joints, *motion_, static_cast<int>(frame), joint);
      const auto place = [&](int bone) {
        const int above = armature_->bones[bone].parent;
        return above < 0 ? armature_->bones[bone].head + travelled(joints)
                         : head[above] + turn[above] * (armature_->bones[bone].head - armature_->bones[above].head);
      };
      for (int bone = 0; bone < std::ssize(turn); ++bone) {
        if (!bone_matters[bone]) continue;
        const int above = armature_->bones[bone].parent;
        head[bone] = place(bone);
        turn[bone] = turned(bone, joints, above < 0 ? glm::dquat(1, 0, 0, 0) : turn[above]);
      }
      for (std::size_t i = 0; i < count; ++i) {
        for (const int point : {FootTrack::Ankle, FootTrack::Toes}) {
          const int bone = bone_of(legs_[i], point);
          if (bone < 0) continue;
          feet[i].source[point][frame] = scale_ * lps_from_bvh(joints[joint_of_bone_[bone]].translation);
          feet[i].body[point][frame] = place(bone);
        }
        feet[i].hip[frame] = head[legs_[i].thigh];
        feet[i].knee[frame] = place(legs_[i].shank);
      }
    }
  });
  return feet;
}

// Rotates thigh and shank so that the ankle moves along the ground by `ankle_aside`, mm. The foot keeps its direction,
// except for a rotation that moves the toes by a further `toes_aside`, mm.
void Retarget::move_foot(Pose& pose, const Leg& leg, const glm::dvec2& ankle_aside,
                         const glm::dvec2& toes_aside) const {
  const auto posed = posed_from_rest(*armature_, pose);
  const auto place = [&](int bone) { return posed[bone] * armature_->bones[bone].head; };
  const auto turned_before = [&](int bone, const glm::dquat& world) {
    const int parent = armature_->bones[bone].parent;
    const glm::dquat carried = parent < 0 ? glm::dquat(1, 0, 0, 0) : posed[parent].rotation;
    pose.rotation[bone] = glm::normalize(glm::conjugate(carried) * world * carried * pose.rotation[bone]);
  };
  TurnsOfLeg turns = turns_of_leg(place(leg.shank) - place(leg.thigh), place(leg.foot) - place(leg.shank), ankle_aside);
  const double may = std::min(1.0, kMostTurn / std::max(turns.most(), 1e-300));
  const glm::dquat thigh = turn_by(may * turns.thigh),
                   shank = leg.shank == leg.foot ? thigh : turn_by(may * turns.shank);
  const glm::dquat foot =
      leg.toes < 0 ? glm::dquat(1, 0, 0, 0) : turn_aside(place(leg.toes) - place(leg.foot), toes_aside);
  // A rotation of a bone also rotates its children. The shank and the foot therefore undo the rotation of the bone
  // above them before they apply their own.
  turned_before(leg.thigh, thigh);
  if (leg.shank != leg.foot) turned_before(leg.shank, glm::conjugate(thigh) * shank);
  turned_before(leg.foot, glm::conjugate(shank) * foot);
}

Pose Retarget::carried_over(const std::vector<RigidTransform>& source) const {
  Pose pose = rest_pose(*armature_);
  std::vector<glm::dquat> posed(joint_of_bone_.size(), glm::dquat(1, 0, 0, 0));
  for (int b = 0; b < std::ssize(posed); ++b) {
    const int parent = armature_->bones[b].parent;
    const glm::dquat carried = parent < 0 ? glm::dquat(1, 0, 0, 0) : posed[parent];
    posed[b] = turned(b, source, carried);
    const bool follows = joint_of_bone_[b] < 0 && between_[b].below < 0;
    if (!follows) pose.rotation[b] = glm::normalize(glm::conjugate(carried) * posed[b]);
  }
  pose.root_translation = travelled(source);
  return pose;
}

glm::dquat Retarget::turned(int bone, const std::vector<RigidTransform>& source, const glm::dquat& carried) const {
  const auto matched = [&](int b) {
    return glm::normalize(lps_from_bvh(source[joint_of_bone_[b]].rotation) * rest_offset_[b]);
  };
  const Between& between = between_[bone];
  if (joint_of_bone_[bone] >= 0) return matched(bone);
  return between.below < 0 ? carried
                           : glm::normalize(glm::slerp(matched(between.below), matched(between.above), between.share));
}

glm::dvec3 Retarget::travelled(const std::vector<RigidTransform>& source) const {
  if (settings_.travel == Travel::Locked || lead_ < 0) return glm::dvec3(0);
  const glm::dvec3 by = scale_ * lps_from_bvh(source[lead_].translation - start_);
  return settings_.travel == Travel::InPlace ? glm::dvec3(0, 0, by.z) : by;
}

}  // namespace limber
