// SPDX-License-Identifier: AGPL-3.0-or-later
// Motion capture in Biovision's BVH format, in the file's own axes and units (usually Y up, often centimetres or inches).
// Rotation order per joint as its CHANNELS say; position channels replace OFFSET (Blender's reading). A Frames count
// that disagrees with the data keeps the whole frames and warns. No MOTION, or zero frames, is a rig.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/rigid_transform.h"

namespace limber {

enum class BvhChannel : std::uint8_t { Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation };

struct BvhJoint {
  std::string name;
  int parent = -1;
  glm::dvec3 offset{0};
  std::vector<BvhChannel> channels;  // 0 to 6, in file order
  int first_channel = 0;             // column of its first channel in a frame
  std::optional<glm::dvec3> end_site;
};

struct Motion {
  std::vector<BvhJoint> joints;  // parents before children, in file order
  int channel_count = 0;
  int frame_count = 0;
  double frame_time = 1.0 / 30;  // s
  std::vector<float> values;     // frame_count x channel_count, degrees and file units
  std::vector<std::string> warnings;
};

// Throws Error with file, line and what to do.
Motion read_bvh(const Path& path);
Motion parse_bvh(const std::string& text, const std::string& where);
void write_bvh(const Motion& motion, const Path& path);

// Global position and rotation of every joint at a frame, file axes and units. frame -1 is the rest pose: all channels
// at zero except that positions keep their OFFSET.
std::vector<RigidTransform> forward_kinematics(const Motion& motion, int frame);

}  // namespace limber
