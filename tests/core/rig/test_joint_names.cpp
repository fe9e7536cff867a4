// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_names.h"

#include <doctest/doctest.h>

#include "core/motion/bvh.h"
#include "core/rig_io/rig_io.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
using P = BodyPart;
constexpr BodySide L = BodySide::Left, R = BodySide::Right, M = BodySide::Middle;

// Names in order, each the child of the one before. "<" in front of a name makes it a child of the root.
struct Named {
  std::vector<std::string> names;
  std::vector<int> parents;

  Named(std::initializer_list<std::string> list) {
    for (const std::string& name : list) {
      const bool from_root = name[0] == '<';
      parents.push_back(names.empty() ? -1 : from_root ? 0 : static_cast<int>(names.size()) - 1);
      names.push_back(from_root ? name.substr(1) : name);
    }
  }

  std::string joint(JointRole role) const {
    const auto roles = joint_roles(names, parents);
    for (size_t j = 0; j < names.size(); ++j)
      if (roles[j] == role) return names[j];
    return "";
  }
};
}  // namespace

TEST_CASE("joint names: the schools of naming are understood") {
  const Named cmu{"Hips",        "LHipJoint", "LeftUpLeg",      "LeftLeg",  "LeftFoot", "LeftToeBase",   "<LowerBack",
                  "Spine",       "Spine1",    "Neck",           "Neck1",    "Head",     "<LeftShoulder", "LeftArm",
                  "LeftForeArm", "LeftHand",  "LeftFingerBase", "LFingers", "<LThumb"};
  CHECK(cmu.joint({P::HipLink, L}) == "LHipJoint");
  CHECK(cmu.joint({P::Thigh, L}) == "LeftUpLeg");
  CHECK(cmu.joint({P::Shank, L}) == "LeftLeg");
  CHECK(cmu.joint({P::Toes, L}) == "LeftToeBase");
  CHECK(cmu.joint({P::Spine, M, 0}) == "LowerBack");
  CHECK(cmu.joint({P::Spine, M, 2}) == "Spine1");
  CHECK(cmu.joint({P::Neck, M, 1}) == "Neck1");
  CHECK(cmu.joint({P::Clavicle, L}) == "LeftShoulder");
  CHECK(cmu.joint({P::UpperArm, L}) == "LeftArm");
  CHECK(cmu.joint({P::Palm, L}) == "LeftFingerBase");
  CHECK(cmu.joint({P::Thumb, L, 1}) == "LThumb");

  const Named mixamo{"mixamorig:Hips",           "mixamorig:Spine",          "mixamorig:Spine1",
                     "mixamorig:Neck",           "mixamorig:Head",           "mixamorig:HeadTop_End",
                     "<mixamorig:RightShoulder", "mixamorig:RightArm",       "mixamorig:RightForeArm",
                     "mixamorig:RightHand",      "mixamorig:RightHandPinky3"};
  CHECK(mixamo.joint({P::Clavicle, R}) == "mixamorig:RightShoulder");
  CHECK(mixamo.joint({P::Little, R, 3}) == "mixamorig:RightHandPinky3");
  CHECK(mixamo.joint({P::Head}) == "mixamorig:Head");

  const Named bank{"Bip01 Hips",         "Bip01 Chest",         "Bip01 Neck",       "Bip01 Head",
                   "<Bip01 Left Collar", "Bip01 Left Shoulder", "Bip01 Left Elbow", "Bip01 Left Wrist",
                   "<Bip01 Left Hip",    "Bip01 Left Knee",     "Bip01 Left Ankle"};
  CHECK(bank.joint({P::Clavicle, L}) == "Bip01 Left Collar");
  CHECK(bank.joint({P::UpperArm, L}) == "Bip01 Left Shoulder");
  CHECK(bank.joint({P::Hand, L}) == "Bip01 Left Wrist");
  CHECK(bank.joint({P::Thigh, L}) == "Bip01 Left Hip");
  CHECK(bank.joint({P::Foot, L}) == "Bip01 Left Ankle");

  const Named bandai{"joint_Root", "Hips",       "Spine",  "Chest",       "Neck",       "Head",   "<Shoulder_L",
                     "UpperArm_L", "LowerArm_L", "Hand_L", "<UpperLeg_R", "LowerLeg_R", "Foot_R", "Toes_R"};
  CHECK(bandai.joint({P::Pelvis}) == "Hips");
  CHECK(bandai.joint({P::Clavicle, L}) == "Shoulder_L");
  CHECK(bandai.joint({P::Shank, R}) == "LowerLeg_R");

  const Named unreal{
      "root",       "pelvis", "spine_01",           "spine_02",   "neck_01",  "head",   "<clavicle_l", "upperarm_l",
      "lowerarm_l", "hand_l", "index_metacarpal_l", "index_01_l", "<thigh_r", "calf_r", "foot_r",      "ball_r"};
  CHECK(unreal.joint({P::Pelvis}) == "pelvis");
  CHECK(unreal.joint({P::Spine, M, 1}) == "spine_02");
  CHECK(unreal.joint({P::Forearm, L}) == "lowerarm_l");
  CHECK(unreal.joint({P::Index, L, 0}) == "index_metacarpal_l");
  CHECK(unreal.joint({P::Index, L, 1}) == "index_01_l");
  CHECK(unreal.joint({P::Toes, R}) == "ball_r");

  const Named makehuman{"root",         "spine05",      "spine04",      "neck01",       "head",    "<clavicle.L",
                        "shoulder01.L", "upperarm01.L", "upperarm02.L", "lowerarm01.L", "wrist.L", "finger2-1.L",
                        "<pelvis.R",    "upperleg01.R", "upperleg02.R", "lowerleg01.R", "foot.R"};
  CHECK(makehuman.joint({P::Clavicle, L}) == "clavicle.L");
  CHECK(makehuman.joint({P::UpperArm, L}) == "upperarm01.L");
  CHECK(makehuman.joint({P::Index, L, 1}) == "finger2-1.L");
  CHECK(makehuman.joint({P::Thigh, R}) == "upperleg01.R");
  CHECK(makehuman.joint({P::Spine, M, 0}) == "spine05");
}

TEST_CASE("joint names: what game and character makers call bones is understood too") {
  const Named vroid{"Root",           "J_Bip_C_Hips",      "J_Bip_C_Spine",    "J_Bip_C_Chest",    "J_Bip_C_Neck",
                    "J_Bip_C_Head",   "<J_Bip_L_Shoulder", "J_Bip_L_UpperArm", "J_Bip_L_LowerArm", "J_Bip_L_Hand",
                    "J_Bip_L_Index2", "<J_Bip_R_UpperLeg", "J_Bip_R_LowerLeg", "J_Bip_R_Foot"};
  CHECK(vroid.joint({P::Pelvis}) == "J_Bip_C_Hips");
  CHECK(vroid.joint({P::Spine, M, 1}) == "J_Bip_C_Chest");
  CHECK(vroid.joint({P::Clavicle, L}) == "J_Bip_L_Shoulder");
  CHECK(vroid.joint({P::Forearm, L}) == "J_Bip_L_LowerArm");
  CHECK(vroid.joint({P::Index, L, 2}) == "J_Bip_L_Index2");
  CHECK(vroid.joint({P::Thigh, R}) == "J_Bip_R_UpperLeg");

  const Named daz{"hip",         "abdomenLower", "chestUpper", "neckLower",   "head",        "<lCollar", "lShldrBend",
                  "lShldrTwist", "lForearmBend", "lHand",      "<rThighBend", "rThighTwist", "rShin",    "rFoot"};
  CHECK(daz.joint({P::UpperArm, L}) == "lShldrBend");
  CHECK(daz.joint({P::Forearm, L}) == "lForearmBend");
  CHECK(daz.joint({P::Thigh, R}) == "rThighBend");
  CHECK(daz.joint({P::Shank, R}) == "rShin");
}

TEST_CASE("joint names: an arm of its own needs no sides") {
  const Named arm{"Humerus",
                  "Forearm",
                  "IndexMetarcapal",
                  "IndexMidllePhalange",
                  "<MiddleMiddlePhalange",
                  "<ThumbProximalPhalange",
                  "<SmallDistalPhalange"};
  CHECK(arm.joint({P::UpperArm, M}) == "Humerus");
  CHECK(arm.joint({P::Forearm, M}) == "Forearm");
  CHECK(arm.joint({P::Index, M, 0}) == "IndexMetarcapal");
  CHECK(arm.joint({P::Index, M, 2}) == "IndexMidllePhalange");
  CHECK(arm.joint({P::Middle, M, 2}) == "MiddleMiddlePhalange");
  CHECK(arm.joint({P::Thumb, M, 2}) == "ThumbProximalPhalange");
  CHECK(arm.joint({P::Little, M, 3}) == "SmallDistalPhalange");
}

TEST_CASE("joint names: a name is the same however it is written") {
  CHECK(plain_name("mixamorig:LeftArm") == plain_name("left_arm"));
  CHECK(plain_name("LeftArm") == plain_name("arm.L"));
  CHECK(plain_name("Spine1") != plain_name("Spine2"));
}
