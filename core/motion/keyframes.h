// SPDX-License-Identifier: AGPL-3.0-or-later
// Keyframes: the rotations that bones take at given frames. They are stored by bone name, so that a change of the rig
// loses only the keys of removed bones. A bone without a key keeps its motion.
//
// A key may have a shape, which says how the bone moves to the next key and how fast it passes through the key. After a
// key without a shape the bone moves to the next key at constant speed. core/motion/key_curve.h evaluates the keys.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

// The change of a value from a key to the next one: it stays until the next key, changes at constant speed, or follows
// a cubic Bezier curve with the tangents of the two keys.
enum class Interpolation : std::uint8_t { Constant, Linear, Bezier };

// The source of a key's tangents. Automatic: the neighbouring keys [Catmull & Rom 1974]. Clamped: the neighbouring
// keys, but without overshoot where the curve turns back. Aligned: the user; both tangents are equal. Free: the user;
// the tangents are independent. Flat: both tangents are zero.
enum class HandleKind : std::uint8_t { Automatic, Clamped, Aligned, Free, Flat };

struct KeyShape {
  Interpolation next = Interpolation::Linear;  // interpolation from this key to the next one
  HandleKind handles = HandleKind::Clamped;
  // The speeds before and after the key, for aligned and free handles: for a bone a rotation vector in the parent
  // bone's frame, radians per frame; for the body's shift mm per frame.
  glm::dvec3 in{0}, out{0};

  bool operator==(const KeyShape&) const = default;
};
using KeyShapes = std::map<int, KeyShape>;  // by frame; a key that is not listed has the shape KeyShape{}

struct Keys {
  // For each bone name, the rotation at each keyed frame. Each listed bone has at least one key.
  std::map<std::string, std::map<int, glm::dquat>> bones;
  std::map<int, glm::dvec3> root;  // for each keyed frame, the body's shift from its rest position, mm
  // The shapes of the keys of `bones` and `root`. Keys with the default shape are not stored, nor are bones without
  // shapes.
  std::map<std::string, KeyShapes> shapes;
  KeyShapes root_shapes;
  // For each constraint's name (core/motion/constraint.h), its weight at each keyed frame, [0, 1], and the shapes of
  // these keys. No listed constraint has an empty map.
  std::map<std::string, std::map<int, double>> weights;
  std::map<std::string, KeyShapes> weight_shapes;

  bool operator==(const Keys&) const = default;
  bool empty() const { return bones.empty() && root.empty() && weights.empty(); }
};

std::set<int> frames_of(const Keys& keys);

// ---- Shapes
KeyShape shape_at(const KeyShapes& shapes, int frame);
const KeyShapes& shapes_of(const Keys& keys, const std::string& bone);
void set_shape(Keys& keys, const std::string& bone, int frame, const KeyShape& shape);
void set_root_shape(Keys& keys, int frame, const KeyShape& shape);
// Multiplies all tangents by a factor, for example when the number of frames per second changes.
void scale_tangents(Keys& keys, double factor);

// ---- Keys

// Sets keys of `bones` at a frame, with the rotations that the bones have in the pose. If a root bone is among them,
// the body's position is keyed too. An existing key keeps its shape. A new key gets clamped handles and the
// interpolation of the key before it, or of the key after it if there is none before.
void insert_key(Keys& keys, const Armature& armature, const Pose& pose, const std::vector<int>& bones, int frame);
// Deletes the keys of the bones at a frame. Returns false if there were no such keys.
bool delete_key(Keys& keys, const Armature& armature, const std::vector<int>& bones, int frame);

// Set or delete a key of a constraint's weight.
void insert_weight_key(Keys& keys, const std::string& constraint, int frame, double weight);
bool delete_weight_key(Keys& keys, const std::string& constraint, int frame);
// Sets the interpolation of all keys of a constraint's weight.
void set_weight_interpolation(Keys& keys, const std::string& constraint, Interpolation next);

// Delete, move or copy all keys at the given frames, with their shapes. A key moved onto a frame that has a key
// replaces it.
void delete_keys(Keys& keys, const std::set<int>& frames);
// Move or copy keys to other frames.
//   frame_of  for each frame whose keys are moved or copied, the new frame; keys at other frames stay
void move_keys(Keys& keys, const std::map<int, int>& frame_of);
void copy_keys(Keys& keys, const std::map<int, int>& frame_of);
// Move or delete the keys of one bone, or the keys of the body's shift.
void move_bone_keys(Keys& keys, const std::string& bone, const std::map<int, int>& frame_of);
void move_root_keys(Keys& keys, const std::map<int, int>& frame_of);
void delete_bone_keys(Keys& keys, const std::string& bone, const std::set<int>& frames);
void delete_root_keys(Keys& keys, const std::set<int>& frames);

}  // namespace limber
