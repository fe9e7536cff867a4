// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/constraints_codec.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/motion/constraint.h"
#include "core/motion/key_curve.h"

namespace limber {

namespace {

constexpr std::int64_t kMostFrame = 1 << 28;  // a larger frame number is refused
constexpr int kLongestChain = 4096;           // a longer chain of bones is refused; a rig has no more bones
constexpr std::size_t kFewestBytes = 138;     // size of a stored constraint with empty names
constexpr double kWidestLimit = 2 * std::numbers::pi;

double get_within(ByteReader& in, double low, double high) {
  const auto value = in.get<double>();
  in.require(std::isfinite(value));
  return std::clamp(value, low, high);
}

template <class Enum>
Enum get_one(ByteReader& in, Enum last) {
  return static_cast<Enum>(in.get_below<std::uint8_t>(static_cast<std::uint64_t>(last) + 1));
}

void put(ByteWriter& out, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) out.put(v[i]);
}
glm::dvec3 get_vector(ByteReader& in, double most) {
  glm::dvec3 v;
  for (int i = 0; i < 3; ++i) v[i] = get_within(in, -most, most);
  return v;
}

void put(ByteWriter& out, const Constraint& constraint) {
  out.text(constraint.name);
  out.put(static_cast<std::uint8_t>(constraint.kind));
  out.flag(constraint.on);
  out.put(constraint.weight);
  out.text(constraint.bone);
  out.text(constraint.target);
  put(out, constraint.place);
  for (const bool axis : constraint.axes) out.flag(axis);
  out.put(static_cast<std::uint8_t>(constraint.space));
  put(out, constraint.minimum);
  put(out, constraint.maximum);
  out.put(static_cast<std::uint8_t>(constraint.aim));
  out.put(static_cast<std::uint8_t>(constraint.point));
  out.flag(constraint.keeps_rotation);
  for (const double value :
       {constraint.rotation.w, constraint.rotation.x, constraint.rotation.y, constraint.rotation.z})
    out.put(value);
  out.put(static_cast<std::int32_t>(constraint.chain));
  out.flag(constraint.keep_limits);
}

Constraint get_constraint(ByteReader& in) {
  Constraint constraint;
  constraint.name = in.text();
  constraint.kind = get_one(in, ConstraintKind::InverseKinematics);
  constraint.on = in.flag();
  constraint.weight = get_within(in, 0, 1);
  constraint.bone = in.text();
  constraint.target = in.text();
  constraint.place = get_vector(in, kFarthestPlace);
  for (bool& axis : constraint.axes) axis = in.flag();
  constraint.space = get_one(in, RotationSpace::Parent);
  constraint.minimum = get_vector(in, kWidestLimit);
  constraint.maximum = get_vector(in, kWidestLimit);
  constraint.aim = get_one(in, BoneAxis::MinusZ);
  constraint.point = get_one(in, PlantPoint::Tip);
  constraint.keeps_rotation = in.flag();
  for (double* value : {&constraint.rotation.w, &constraint.rotation.x, &constraint.rotation.y, &constraint.rotation.z})
    *value = get_within(in, -1, 1);
  in.require(std::abs(glm::length(constraint.rotation) - 1) < 1e-6);
  constraint.chain = in.get_below<std::int32_t>(kLongestChain + 1);
  constraint.keep_limits = in.flag();
  return constraint;
}

void get_weights(ByteReader& in, std::map<int, double>& track, KeyShapes& shapes) {
  for (std::size_t count = in.count(62); count > 0; --count) {
    const auto frame = in.get<std::int32_t>();
    in.require(std::abs(std::int64_t{frame}) <= kMostFrame);
    track[frame] = get_within(in, 0, 1);
    KeyShape shape;
    shape.next = get_one(in, Interpolation::Bezier);
    shape.handles = get_one(in, HandleKind::Flat);
    shape.in = get_vector(in, kSteepestTangent);
    shape.out = get_vector(in, kSteepestTangent);
    if (shape != KeyShape{}) shapes[frame] = shape;
  }
}

}  // namespace

bool has_constraints(const Clip& clip) {
  return (clip.constraints && !clip.constraints->list.empty()) || !clip.keys.weights.empty();
}

void put_constraints(ByteWriter& out, const Clip& clip) {
  static const Constraints kNone;
  const Constraints& constraints = clip.constraints ? *clip.constraints : kNone;
  out.count(constraints.list.size());
  for (const Constraint& constraint : constraints.list) put(out, constraint);
  out.count(clip.keys.weights.size());
  static const KeyShapes kPlain;
  for (const auto& [name, track] : clip.keys.weights) {
    const auto found = clip.keys.weight_shapes.find(name);
    const KeyShapes& shapes = found == clip.keys.weight_shapes.end() ? kPlain : found->second;
    out.text(name);
    out.count(track.size());
    for (const auto& [frame, weight] : track) {
      const KeyShape shape = shape_at(shapes, frame);
      out.put(static_cast<std::int32_t>(frame));
      out.put(weight);
      out.put(static_cast<std::uint8_t>(shape.next));
      out.put(static_cast<std::uint8_t>(shape.handles));
      put(out, shape.in);
      put(out, shape.out);
    }
  }
}

void get_constraints(ByteReader& in, Clip& clip) {
  Constraints constraints;
  std::set<std::string> names;
  const std::size_t constraints_count = in.count(kFewestBytes);
  in.require(constraints_count <= kMostConstraints);
  for (std::size_t count = constraints_count; count > 0; --count) {
    constraints.list.push_back(get_constraint(in));
    in.require(names.insert(constraints.list.back().name).second);
  }
  for (std::size_t count = in.count(8); count > 0; --count) {
    const std::string name = in.text();
    std::map<int, double> track;
    KeyShapes shapes;
    get_weights(in, track, shapes);
    if (track.empty() || !names.contains(name)) continue;
    clip.keys.weights[name] = std::move(track);
    if (!shapes.empty()) clip.keys.weight_shapes[name] = std::move(shapes);
  }
  if (!constraints.list.empty()) clip.constraints = std::make_shared<const Constraints>(std::move(constraints));
}

}  // namespace limber
