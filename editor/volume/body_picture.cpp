// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/body_picture.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/pose/anatomical_frames.h"
#include "core/rig/anatomical_position.h"

namespace limber::editor {

namespace {

constexpr double kTurn = 0.7;     // turn of the view to the side, radians; shows limbs held in front of the body
constexpr double kTilt = 0.12;    // angle by which the view looks down, radians
constexpr double kMargin = 0.06;  // free margin on each side of the picture, as a fraction of the body's extent
constexpr int kSamples = 2;       // number of samples per pixel in x and in y
constexpr double kShadow = 0.3;   // brightness of surfaces that the light does not reach, [0, 1]
const glm::dvec3 kColour(0.86, 0.68, 0.55), kLight = glm::normalize(glm::dvec3(-0.4, 0.5, 0.8));

// A cylinder with round ends whose axis goes from `a` to `b`. Coordinates are mm in the axes of the picture: x points
// right, y up, z towards the eye.
struct Solid {
  glm::dvec3 a, b;
  double radius;
};

// Returns the radius of the cylinder that is drawn for a bone, as a fraction of the body's height. 0: the bone is not
// drawn.
double radius_of(const std::optional<JointRole>& role) {
  if (!role) return 0;
  switch (role->part) {
    case BodyPart::Pelvis:
    case BodyPart::Spine: return 0.06;
    case BodyPart::Head: return 0.055;
    case BodyPart::HipLink:
    case BodyPart::Thigh: return 0.042;
    case BodyPart::Neck:
    case BodyPart::Clavicle:
    case BodyPart::Shank: return 0.03;
    case BodyPart::UpperArm: return 0.026;
    case BodyPart::Forearm: return 0.021;
    case BodyPart::Foot: return 0.02;
    case BodyPart::Hand:
    case BodyPart::Palm:
    case BodyPart::Toes: return 0.016;
    default: return 0.008;
  }
}

double height_of(const Armature& armature) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const Bone& bone : armature.bones)
    for (const glm::dvec3& end : {bone.head, bone.tail}) low = glm::min(low, end), high = glm::max(high, end);
  const glm::dvec3 extent = high - low;
  return std::max({extent.x, extent.y, extent.z, 1e-9});
}

std::vector<Solid> solids_of(const Armature& armature, const Pose& pose) {
  const std::vector<RigidTransform> world = posed_from_rest(armature, pose);
  const auto roles = roles_of(armature);
  const double height = height_of(armature);
  const glm::dquat turn = glm::angleAxis(kTilt, glm::dvec3(1, 0, 0)) * glm::angleAxis(-kTurn, glm::dvec3(0, 1, 0));
  const glm::dmat3 upright = upright_axes(armature);
  // Converts a world position to the picture's axes: the body's left becomes x (right), up becomes y (up), front
  // becomes z (towards the eye). Then turns and tilts the view.
  const auto seen = [&](const glm::dvec3& place) {
    const glm::dvec3 p = glm::transpose(upright) * place;
    return turn * glm::dvec3(p.x, p.z, -p.y);
  };
  std::vector<Solid> solids;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    const double radius = radius_of(roles[b]) * height;
    if (radius > 0)
      solids.push_back({seen(world[b] * armature.bones[b].head), seen(world[b] * armature.bones[b].tail), radius});
  }
  return solids;
}

// The point of a solid's surface that is visible at a position of the picture: its depth (z, mm) and the surface
// normal.
struct Seen {
  double depth;
  glm::dvec3 normal;
};

std::optional<Seen> on_ball(const glm::dvec3& middle, double radius, const glm::dvec2& at) {
  const glm::dvec2 off = at - glm::dvec2(middle);
  const double square = radius * radius - glm::dot(off, off);
  if (square < 0) return std::nullopt;
  return Seen{middle.z + std::sqrt(square), glm::dvec3(off, std::sqrt(square)) / radius};
}

std::optional<Seen> seen_at(const Solid& solid, const glm::dvec2& at) {
  std::optional<Seen> nearest;
  const auto take = [&](const std::optional<Seen>& one) {
    if (one && (!nearest || one->depth > nearest->depth)) nearest = one;
  };
  take(on_ball(solid.a, solid.radius, at));
  take(on_ball(solid.b, solid.radius, at));
  // Intersects the line of sight with the curved side of the cylinder. The intersection is the point on the line whose
  // distance from the cylinder's axis equals the radius; it counts only between the cylinder's ends.
  const glm::dvec3 axis = solid.b - solid.a, from(at.x - solid.a.x, at.y - solid.a.y, -solid.a.z);
  const double length2 = glm::dot(axis, axis), ray = axis.z, start = glm::dot(from, axis);
  const double a = length2 - ray * ray, b = length2 * from.z - start * ray;
  const double c = length2 * (glm::dot(from, from) - solid.radius * solid.radius) - start * start;
  const double root = b * b - a * c;
  if (a > 1e-9 * length2 && root >= 0) {
    const double depth = (-b + std::sqrt(root)) / a, along = start + depth * ray;
    if (along > 0 && along < length2) {
      const glm::dvec3 place = from + glm::dvec3(0, 0, depth);
      take(Seen{depth, glm::normalize(place - axis * (along / length2))});
    }
  }
  return nearest;
}

struct Frame {
  glm::dvec2 low;      // the picture's lower left corner, mm
  double millimetres;  // edge of a pixel, mm
};

Frame frame_of(const std::vector<Solid>& solids, const glm::ivec2& size) {
  glm::dvec2 low(1e300), high(-1e300);
  for (const Solid& solid : solids)
    for (const glm::dvec3& end : {solid.a, solid.b})
      low = glm::min(low, glm::dvec2(end) - solid.radius), high = glm::max(high, glm::dvec2(end) + solid.radius);
  const glm::dvec2 extent = (high - low) * (1 + 2 * kMargin);
  const double millimetres = std::max({extent.x / size.x, extent.y / size.y, 1e-9});
  return {(low + high) / 2.0 - glm::dvec2(size) * millimetres / 2.0, millimetres};
}

// Renders the solids into samples. Each sample has the brightness of the solid that is nearest to the eye, or -1 where
// there is no solid. The first row is at the top of the picture.
class Samples {
 public:
  Samples(const Frame& frame, const glm::ivec2& size)
      : frame_{frame.low, frame.millimetres / kSamples},
        size_(size * kSamples),
        depth_(count(), -1e300),
        light_(count(), -1.0f) {}

  void add(const Solid& solid) {
    const auto row_and_column = [&](const glm::dvec2& at) {
      return glm::ivec2(glm::floor((at - frame_.low) / frame_.millimetres));
    };
    const glm::dvec2 a(solid.a), b(solid.b);
    const glm::ivec2 low = glm::max(row_and_column(glm::min(a, b) - solid.radius), glm::ivec2(0));
    const glm::ivec2 high = glm::min(row_and_column(glm::max(a, b) + solid.radius), size_ - 1);
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const auto seen = seen_at(solid, frame_.low + (glm::dvec2(x, y) + 0.5) * frame_.millimetres);
        const std::size_t sample = std::size_t(size_.y - 1 - y) * std::size_t(size_.x) + std::size_t(x);
        if (!seen || seen->depth <= depth_[sample]) continue;
        depth_[sample] = seen->depth;
        light_[sample] = static_cast<float>(kShadow + (1 - kShadow) * std::max(0.0, glm::dot(seen->normal, kLight)));
      }
  }

  float light(const glm::ivec2& sample) const {
    return light_[std::size_t(sample.y) * std::size_t(size_.x) + std::size_t(sample.x)];
  }

 private:
  std::size_t count() const { return std::size_t(size_.x) * std::size_t(size_.y); }

  Frame frame_;
  glm::ivec2 size_;
  std::vector<double> depth_;
  std::vector<float> light_;
};

}  // namespace

render::Image body_picture(const Armature& armature, const Pose& pose, const glm::ivec2& size) {
  const std::vector<Solid> solids = solids_of(armature, pose);
  render::Image image{size, std::vector<std::uint8_t>(std::size_t(size.x) * std::size_t(size.y) * 4)};
  if (solids.empty()) return image;
  Samples samples(frame_of(solids, size), size);
  for (const Solid& solid : solids) samples.add(solid);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      double light = 0;
      int covered = 0;
      for (int sample = 0; sample < kSamples * kSamples; ++sample) {
        const float here = samples.light({x * kSamples + sample % kSamples, y * kSamples + sample / kSamples});
        if (here >= 0) light += here, ++covered;
      }
      if (!covered) continue;
      std::uint8_t* pixel = image.rgba.data() + 4 * (std::size_t(y) * std::size_t(size.x) + std::size_t(x));
      for (int channel = 0; channel < 3; ++channel)
        pixel[channel] = static_cast<std::uint8_t>(std::lround(255 * kColour[channel] * light / covered));
      pixel[3] = static_cast<std::uint8_t>(255 * covered / (kSamples * kSamples));
    }
  return image;
}

}  // namespace limber::editor
