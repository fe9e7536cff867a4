// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes motion capture in Biovision's BVH format, in the file's own axes and units (usually Y up, often
// centimetres or inches).
//
// The format has no standard, so this reader accepts what real files hold: rotation orders that differ from joint to
// joint, no End Site, several roots, zero to six channels, rotations before positions, any line end, tabs, exponents,
// braces next to words without a blank, spaces in names, keywords in any case, a byte order mark. Position channels
// *replace* the OFFSET's component, as in Blender; adding them to the OFFSET would move joints of real files by up to
// 104 units. A frame may run over several lines. Where the number of frames in the header disagrees with the data, the
// complete frames are kept and a warning says so. A file without MOTION, or with zero frames, is read as a rig.
// Ambiguous files are refused with the line number: unbalanced braces, a row with a wrong number of values, numbers
// that are not finite.
//
// A file holds at most 4096 joints. Memory grows with the data that are present, whatever the header announces, and the
// time is linear in the number of bytes.
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
  std::vector<BvhChannel> channels;  // the joint's 0 to 6 channels in file order; rotations multiply in this order
  int first_channel = 0;             // column of the joint's first channel in a frame's row
  std::optional<glm::dvec3> end_site;

  bool operator==(const BvhJoint&) const = default;
};

struct Motion {
  std::vector<BvhJoint> joints;  // parents before children, in file order, names unique
  int channel_count = 0;
  int frame_count = 0;
  double frame_time = 1.0 / 30;  // time from one frame to the next, seconds
  std::vector<float> values;     // one row of channel_count values for each frame, degrees and file units
  std::vector<std::string> warnings;
};

// Read a BVH file, or the text of one. Both functions throw Error with file, line and what to do.
Motion read_bvh(const Path& path);
Motion parse_bvh(const std::string& text, const std::string& where);

// Writes a file that reads back as the same joints and values. The text is nested, so the joints are written depth
// first. A joint's name keeps its spaces; line breaks and braces become underscores.
void write_bvh(const Motion& motion, const Path& path);
std::string bvh_text(const Motion& motion);

// Returns the global position and rotation of every joint at a frame [0, frame_count), in file axes and units. Frame -1
// is the rest pose: all rotations are zero and every joint is at its OFFSET.
std::vector<RigidTransform> forward_kinematics(const Motion& motion, int frame);
// Computes the global transform of one joint and stores it in world[joint]. The transform of the joint's parent must
// already be in `world`.
void place_joint(std::vector<RigidTransform>& world, const Motion& motion, int frame, int joint);

// Convert between LPS axes (mm) and BVH axes: BVH's Y up is z up in LPS, BVH's +Z is anterior.
inline glm::dvec3 lps_from_bvh(const glm::dvec3& p) { return {p.x, -p.z, p.y}; }
inline glm::dvec3 bvh_from_lps(const glm::dvec3& p) { return {p.x, p.z, -p.y}; }
inline glm::dquat lps_from_bvh(const glm::dquat& q) { return {q.w, q.x, -q.z, q.y}; }

// Makes a rig from the hierarchy at rest, with one bone per joint. A bone ends at the mean position of the joint's
// children, else at its End Site, else a little further in its parent's direction. One unit of the file is read as 1
// mm.
Armature armature_of(const Motion& motion);

// Makes a hierarchy without frames from the rig. The tail of a bone without children becomes an End Site.
Motion motion_of(const Armature& armature);

}  // namespace limber
