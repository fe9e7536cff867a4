// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/support/walker.h"

namespace limber::test {

Armature hanging_body() {
  Armature rig;
  auto add = [&](const char* name, const char* parent, glm::dvec3 head, glm::dvec3 tail) {
    rig.bones.push_back({name, *parent ? *rig.find(parent) : -1, head, tail});
  };
  add("Pelvis", "", {0, 0, 900}, {0, 0, 1000});
  add("SpineLow", "Pelvis", {0, 0, 1000}, {0, 0, 1150});
  add("SpineMiddle", "SpineLow", {0, 0, 1150}, {0, 0, 1300});
  add("SpineTop", "SpineMiddle", {0, 0, 1300}, {0, 0, 1450});
  add("Neck", "SpineTop", {0, 0, 1450}, {0, 0, 1550});
  for (double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? "Left" : "Right";
    auto limb = [&](const char* name, const std::string& parent, glm::dvec3 head, glm::dvec3 tail) {
      add((s + name).c_str(), parent.c_str(), head * glm::dvec3(side, 1, 1), tail * glm::dvec3(side, 1, 1));
    };
    limb("UpperArm", "SpineTop", {200, 0, 1400}, {220, 0, 1100});
    limb("Forearm", s + "UpperArm", {220, 0, 1100}, {230, -30, 850});
    limb("Hand", s + "Forearm", {230, -30, 850}, {230, -40, 700});
    limb("Thigh", "Pelvis", {90, 0, 900}, {90, 0, 480});
    limb("Shank", s + "Thigh", {90, 0, 480}, {90, 0, 80});
    limb("Foot", s + "Shank", {90, 0, 80}, {110, -150, 0});
  }
  return rig;
}

Motion t_pose_body(const std::vector<std::array<double, 3>>& frames) {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 9 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  int joints = 1;
  auto open = [&](const std::string& name, const std::string& offset) {
    text += "JOINT " + name + "\n{\nOFFSET " + offset + "\nCHANNELS 3 Zrotation Xrotation Yrotation\n";
    ++joints;
  };
  open("Spine", "0 1 0");
  open("Chest", "0 2 0");
  open("Neck", "0 2 0");
  text += "End Site\n{\nOFFSET 0 1 0\n}\n}\n";
  for (const std::string side : {"Left", "Right"}) {
    const std::string sign = side == "Left" ? "" : "-";
    open(side + "Arm", sign + "2 1.5 0");
    open(side + "ForeArm", sign + "3 0 0");
    open(side + "Hand", sign + "2.5 0 0");
    text += "End Site\n{\nOFFSET " + sign + "1 0 0\n}\n}\n}\n}\n";
  }
  text += "}\n}\n";
  for (const std::string side : {"Left", "Right"}) {
    open(side + "UpLeg", (side == "Left" ? "1" : "-1") + std::string(" 0 0"));
    open(side + "Leg", "0 -4 0");
    open(side + "Foot", "0 -4 0");
    text += "End Site\n{\nOFFSET 0 -0.5 1.5\n}\n}\n}\n}\n";
  }
  text += "}\nMOTION\nFrames: " + std::to_string(frames.size()) + "\nFrame Time: 0.01\n";
  for (size_t f = 0; f < frames.size(); ++f) {
    text += std::to_string(f) + " 9 0";
    for (int j = 0; j < joints; ++j)
      for (double angle : frames[f]) text += " " + std::to_string(angle * (1 + 0.1 * j));
    text += "\n";
  }
  return parse_bvh(text, "test");
}

}  // namespace limber::test
