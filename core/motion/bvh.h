// SPDX-License-Identifier: AGPL-3.0-or-later
// Motion capture in Biovision's BVH format, in the file's own axes and units (usually Y up, often centimetres or
// inches).
//
// The format has no standard, so this reader takes what real files hold: rotation orders that differ from joint to
// joint, no End Site, several roots, zero to six channels, rotations before positions, any line end, tabs, exponents,
// braces glued to words, spaces in names, any case of keywords, a byte order mark. Position channels *replace* the
// OFFSET's component (Blender's reading; adding them puts real files off by up to 104 units). A frame may run over
// several lines. Where the header's Frames disagrees with the data, the whole frames are kept and a warning says so; no
// MOTION, or zero frames, is a rig. What cannot be read with one meaning is refused with its line: unbalanced braces, a
// row with a wrong number of values, numbers that are not finite.
//
// At most 4096 joints; memory follows the data that are there, never the header's promise; time is linear in the bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/rigid_transform.h"
#include "core/rig/armature.h"

namespace limber {

enum class BvhChannel : std::uint8_t { Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation };

struct BvhJoint {
  std::string name;
  int parent = -1;
  glm::dvec3 offset{0};
  std::vector<BvhChannel> channels;  // 0 to 6, in file order; rotations multiply in this order
  int first_channel = 0;             // column of its first channel in a frame
  std::optional<glm::dvec3> end_site;

  bool operator==(const BvhJoint&) const = default;
};

struct Motion {
  std::vector<BvhJoint> joints;  // parents before children, in file order, names unique
  int channel_count = 0;
  int frame_count = 0;
  double frame_time = 1.0 / 30;  // s
  std::vector<float> values;     // frame_count x channel_count, degrees and file units
  std::vector<std::string> warnings;
};

// Throws Error with file, line and what to do.
Motion read_bvh(const Path& path);
Motion parse_bvh(const std::string& text, const std::string& where);

// What reads back as the same joints and values; joints that do not follow their parents are put behind them, since the
// text nests. A joint's name keeps its spaces and loses line breaks and braces.
void write_bvh(const Motion& motion, const Path& path);
std::string bvh_text(const Motion& motion);

// Global position and rotation of every joint at a frame [0, frame_count), in file axes and units. Frame -1 is the rest
// pose: all rotations zero and every joint at its OFFSET.
std::vector<RigidTransform> forward_kinematics(const Motion& motion, int frame);
// The same for one joint, whose parent is placed already.
void place_joint(std::vector<RigidTransform>& world, const Motion& motion, int frame, int joint);

// World LPS from BVH axes: Y up becomes z up, +Z becomes anterior.
inline glm::dvec3 lps_from_bvh(const glm::dvec3& p) { return {p.x, -p.z, p.y}; }
inline glm::dvec3 bvh_from_lps(const glm::dvec3& p) { return {p.x, p.z, -p.y}; }
inline glm::dquat lps_from_bvh(const glm::dquat& q) { return {q.w, q.x, -q.z, q.y}; }

// The hierarchy at rest as a rig: a bone per joint, from the joint to the mean of its children, or to its End Site, or
// a little way on from its parent. Lengths stay the file's, read as mm.
Armature armature_of(const Motion& motion);

// The rig as a hierarchy without frames. A tail that is no child's head becomes an End Site, if the bone has no
// children.
Motion motion_of(const Armature& armature);

}  // namespace limber
