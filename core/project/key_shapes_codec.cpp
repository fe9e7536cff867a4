// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/key_shapes_codec.h"

#include <cmath>
#include <cstdlib>

#include "core/motion/key_curve.h"

namespace limber {

namespace {

constexpr std::int64_t kMostFrame = 1 << 28;  // a larger frame number, of either sign, is refused

void put(ByteWriter& out, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) out.put(v[i]);
}

void put(ByteWriter& out, const KeyShapes& shapes) {
  out.count(shapes.size());
  for (const auto& [frame, shape] : shapes) {
    out.put(static_cast<std::int32_t>(frame));
    out.put(static_cast<std::uint8_t>(shape.next));
    out.put(static_cast<std::uint8_t>(shape.handles));
    put(out, shape.in);
    put(out, shape.out);
  }
}

glm::dvec3 get_tangent(ByteReader& in) {
  glm::dvec3 v;
  for (int i = 0; i < 3; ++i) {
    v[i] = in.get<double>();
    in.require(std::isfinite(v[i]));
  }
  return glm::clamp(v, -kSteepestTangent, kSteepestTangent);
}

// Reads the shapes of the keys of one bone, or of the body's shift. Leaves out the shape of a key that does not exist.
template <class Track>
void get(ByteReader& in, KeyShapes& shapes, const Track& track) {
  for (std::size_t count = in.count(54); count > 0; --count) {
    const auto frame = in.get<std::int32_t>();
    in.require(std::abs(std::int64_t{frame}) <= kMostFrame);
    KeyShape shape;
    shape.next = static_cast<Interpolation>(in.get_below<std::uint8_t>(static_cast<int>(Interpolation::Bezier) + 1));
    shape.handles = static_cast<HandleKind>(in.get_below<std::uint8_t>(static_cast<int>(HandleKind::Flat) + 1));
    shape.in = get_tangent(in);
    shape.out = get_tangent(in);
    in.require(shape != KeyShape{});
    if (track.contains(frame)) shapes[frame] = shape;
  }
}

}  // namespace

void put_shapes(ByteWriter& out, const Keys& keys) {
  out.count(keys.shapes.size());
  for (const auto& [bone, shapes] : keys.shapes) {
    out.text(bone);
    put(out, shapes);
  }
  put(out, keys.root_shapes);
}

void get_shapes(ByteReader& in, Keys& keys) {
  for (std::size_t bones = in.count(62); bones > 0; --bones) {
    const std::string bone = in.text();
    const auto track = keys.bones.find(bone);
    KeyShapes shapes;
    get(in, shapes, track == keys.bones.end() ? std::map<int, glm::dquat>{} : track->second);
    if (!shapes.empty()) keys.shapes[bone] = std::move(shapes);
  }
  get(in, keys.root_shapes, keys.root);
}

}  // namespace limber
