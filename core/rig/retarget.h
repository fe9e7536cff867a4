// SPDX-License-Identifier: AGPL-3.0-or-later
// Motion of one skeleton carried over to another. Joints are matched by names (own synonym table for CMU, Mixamo,
// Rokoko, Bandai, MakeHuman, Bender, BodyParts3D) or by a map file {"source joint": "rig bone"}; scale comes from the
// skeletons' heights; rest-pose offsets make *directions*, not angles, carry over.
#pragma once

#include <map>
#include <string>

#include "core/pose/pose.h"
#include "core/rig/bvh.h"

namespace limber {

struct RetargetMap {
  struct Target {
    std::string bone;
    std::optional<glm::dquat> rest_offset;  // turns the source's rest direction onto the rig's
  };
  std::map<std::string, Target> targets;  // by source joint
};

// By names and hierarchy. Throws Error when nothing matches.
RetargetMap match_by_names(const Motion& motion, const Armature& armature);
RetargetMap read_retarget_map(const Path& path, const Motion& motion, const Armature& armature);
void write_retarget_map(const RetargetMap& map, const Path& path);

struct RetargetSettings {
  bool in_place = true;  // false: the root's travel moves the body (--root-motion)
};

// Prepared once, asked for many frames.
class Retarget {
 public:
  Retarget(const Motion& motion, const Armature& armature, const RetargetMap& map, const RetargetSettings& settings = {});
  Pose at(int frame) const;  // throws Error for a frame the motion lacks

 private:
  const Motion* motion_;
  const Armature* armature_;
  RetargetSettings settings_;
  std::vector<int> joint_of_bone_;       // -1 where unmatched
  std::vector<glm::dquat> rig_from_source_;  // per bone
  double scale_ = 1;                     // mm per file unit
};

}  // namespace limber
