// SPDX-License-Identifier: AGPL-3.0-or-later
// A rig of a whole body, built in code in the anatomical position: upright along LPS, limbs straight, arms hanging,
// palms and feet forward. Tests turn its joints to make rigs with other rest poses.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/pose/apply_pose_as_rest.h"
#include "core/rig/pose.h"

namespace limber::test {

// A naming convention for the bones of a rig.
struct RigNames {
  std::string pelvis, spine, chest, neck, head;
  // "@" stands for the side, which is written as `left` or `right`.
  std::string clavicle, upper_arm, forearm, hand, thigh, shank, foot, toes;
  std::string finger;  // "#" stands for the finger ("Index" .. "Little"), "%" for its segment
  std::string left = "Left", right = "Right";
  std::vector<std::string> fingers{"Thumb", "Index", "Middle", "Ring", "Little"};
};

inline const RigNames kAnatomistsNames{"Pelvis",   "Lumbar", "Thorax", "Neck",   "Head",  "@Clavicle", "@UpperArm",
                                       "@Forearm", "@Hand",  "@Thigh", "@Shank", "@Foot", "@Toes",     "@Hand#%"};
inline const RigNames kMixamoNames{"mixamorig:Hips",
                                   "mixamorig:Spine",
                                   "mixamorig:Spine1",
                                   "mixamorig:Neck",
                                   "mixamorig:Head",
                                   "mixamorig:@Shoulder",
                                   "mixamorig:@Arm",
                                   "mixamorig:@ForeArm",
                                   "mixamorig:@Hand",
                                   "mixamorig:@UpLeg",
                                   "mixamorig:@Leg",
                                   "mixamorig:@Foot",
                                   "mixamorig:@ToeBase",
                                   "mixamorig:@Hand#%",
                                   "Left",
                                   "Right",
                                   {"Thumb", "Index", "Middle", "Ring", "Pinky"}};
inline const RigNames kBlenderNames{"pelvis",
                                    "spine",
                                    "chest",
                                    "neck",
                                    "head",
                                    "clavicle.@",
                                    "upper_arm.@",
                                    "forearm.@",
                                    "hand.@",
                                    "thigh.@",
                                    "shin.@",
                                    "foot.@",
                                    "toe.@",
                                    "f_#.0%.@",
                                    "L",
                                    "R",
                                    {"thumb", "index", "middle", "ring", "pinky"}};
inline const RigNames kUnrealNames{"pelvis",
                                   "spine_01",
                                   "spine_02",
                                   "neck_01",
                                   "head",
                                   "clavicle_@",
                                   "upperarm_@",
                                   "lowerarm_@",
                                   "hand_@",
                                   "thigh_@",
                                   "calf_@",
                                   "foot_@",
                                   "ball_@",
                                   "#_0%_@",
                                   "l",
                                   "r",
                                   {"thumb", "index", "middle", "ring", "pinky"}};

inline std::string all_replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at; (at = text.find(what)) != text.npos;) text.replace(at, what.size(), with);
  return text;
}

inline Armature body_rig(const RigNames& names = kAnatomistsNames, bool with_fingers = true) {
  Armature rig;
  const auto add = [&](const std::string& name, int parent, const glm::dvec3& head, const glm::dvec3& tail) {
    rig.bones.push_back({.name = name, .parent = parent, .head = head, .tail = tail});
    return static_cast<int>(rig.bones.size()) - 1;
  };
  const int pelvis = add(names.pelvis, -1, {0, 0, 950}, {0, 0, 1050}),
            spine = add(names.spine, pelvis, {0, 0, 1050}, {0, 0, 1200});
  const int chest = add(names.chest, spine, {0, 0, 1200}, {0, 0, 1450}),
            neck = add(names.neck, chest, {0, 0, 1450}, {0, 0, 1550});
  add(names.head, neck, {0, 0, 1550}, {0, 0, 1750});
  for (const double out : {1.0, -1.0}) {
    const auto sided = [&](const std::string& name) {
      return all_replaced(name, "@", out > 0 ? names.left : names.right);
    };
    const auto at = [&](double aside, double back, double up) { return glm::dvec3(out * aside, back, up); };
    const int clavicle = add(sided(names.clavicle), chest, at(20, -40, 1420), at(180, 0, 1420));
    const int upper = add(sided(names.upper_arm), clavicle, at(180, 0, 1420), at(180, 0, 1120));
    const int fore = add(sided(names.forearm), upper, at(180, 0, 1120), at(180, 0, 860));
    const int hand = add(sided(names.hand), fore, at(180, 0, 860), at(180, 0, 820));
    for (int finger = 0; with_fingers && finger < 5; ++finger) {
      const double aside = 180 + 40 - 20 * finger;
      const bool thumb = finger == 0;
      int parent = hand;
      for (int segment = 1; segment <= 3; ++segment) {
        const double top = (thumb ? 830 : 770) - 30 * (segment - 1);
        parent =
            add(all_replaced(all_replaced(sided(names.finger), "#", names.fingers[static_cast<std::size_t>(finger)]),
                             "%", std::to_string(segment)),
                parent, at(aside, 0, top), at(aside, 0, top - 30));
      }
    }
    const int thigh = add(sided(names.thigh), pelvis, at(90, 0, 930), at(90, 0, 500)),
              shank = add(sided(names.shank), thigh, at(90, 0, 500), at(90, 0, 90));
    const int foot = add(sided(names.foot), shank, at(90, 0, 90), at(90, -130, 30));
    add(sided(names.toes), foot, at(90, -130, 30), at(90, -190, 22));
  }
  return rig;
}

// A rotation of one bone about a world axis, in degrees. rested() makes the rotated pose the new rest pose.
struct HandTurn {
  std::string bone;
  glm::dvec3 axis;
  double degrees;
};

inline Armature rested(const Armature& rig, const std::vector<HandTurn>& turns) {
  Pose pose = rest_pose(rig);
  for (const HandTurn& turn : turns) {
    glm::dquat& rotation = pose.rotation[static_cast<std::size_t>(require_bone(rig, turn.bone))];
    rotation = glm::angleAxis(glm::radians(turn.degrees), glm::normalize(turn.axis)) * rotation;
  }
  return with_pose_as_rest(rig, pose);
}

// Returns the rig rotated and then moved as a whole.
inline Armature moved(Armature rig, const glm::dquat& turn, const glm::dvec3& by) {
  for (Bone& bone : rig.bones) {
    const glm::dvec3 x = turn * rest_axes(bone)[0];
    bone.head = turn * bone.head + by;
    bone.tail = turn * bone.tail + by;
    bone.roll = roll_of(bone, x);
    bone.limits.axis = turn * bone.limits.axis;
  }
  return rig;
}

// Returns the direction of a bone, from head to tail, in a pose, as a unit vector.
inline glm::dvec3 posed_direction(const Armature& rig, const Pose& pose, const std::string& name) {
  const auto b = static_cast<std::size_t>(require_bone(rig, name));
  return posed_from_rest(rig, pose)[b].rotation * glm::normalize(rig.bones[b].tail - rig.bones[b].head);
}

}  // namespace limber::test
