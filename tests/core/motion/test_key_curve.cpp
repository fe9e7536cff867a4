// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/key_curve.h"

#include <random>

#include <doctest/doctest.h>

#include "core/motion/clip.h"

namespace limber::test {

namespace {

constexpr double kPi = 3.14159265358979323846;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return low + (high - low) * static_cast<double>(engine_()) / 4294967295.0; }
  glm::dvec3 vector(double most) { return {in(-most, most), in(-most, most), in(-most, most)}; }
  glm::dquat rotation() { return glm::normalize(glm::dquat(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1))); }

 private:
  std::mt19937 engine_;
};

double degrees_apart(const glm::dquat& a, const glm::dquat& b) { return glm::degrees(glm::length(turn_between(a, b))); }
glm::dquat about_x(double radians) { return {std::cos(radians / 2), std::sin(radians / 2), 0, 0}; }
glm::dquat from_vector(const glm::dvec3& v) {
  const double angle = glm::length(v);
  return angle == 0 ? glm::dquat(1, 0, 0, 0) : glm::angleAxis(angle, v / angle);
}

// Evaluates a cubic Bezier curve by de Casteljau's algorithm, with handles at thirds of the time.
double scalar_bezier(double a, double v0, double b, double v1, double frames, double share) {
  double p[] = {a, a + v0 * frames / 3, b - v1 * frames / 3, b};
  for (int left = 3; left > 0; --left)
    for (int i = 0; i < left; ++i) p[i] = (1 - share) * p[i] + share * p[i + 1];
  return p[0];
}

struct FourKeys {
  std::map<int, glm::dquat> keys;
  KeyShapes shapes;
};
FourKeys four_keys(unsigned seed, HandleKind handles) {
  Random random(seed);
  FourKeys four;
  glm::dquat q = random.rotation();
  for (const int frame : {-3, 10, 17, 40}) {
    four.keys[frame] = q;
    const glm::dvec3 speed = random.vector(0.05);
    four.shapes[frame] = {Interpolation::Bezier, handles, speed, handles == HandleKind::Free ? -speed : speed};
    q = glm::normalize(from_vector(random.vector(0.8)) * q);
  }
  return four;
}

glm::dvec3 speed_at(const FourKeys& four, double frame, double step) {
  return turn_between(value_at(four.keys, four.shapes, frame), value_at(four.keys, four.shapes, frame + step)) / step;
}

}  // namespace

TEST_CASE("key curve: a bone passes its keys with exactly the speeds of their tangents") {
  constexpr double kStep = 1e-5;
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const HandleKind handles : {HandleKind::Automatic, HandleKind::Clamped, HandleKind::Free, HandleKind::Flat}) {
      const FourKeys four = four_keys(seed, handles);
      for (const int frame : {10, 17}) {
        CHECK(degrees_apart(value_at(four.keys, four.shapes, frame), four.keys.at(frame)) < 1e-6);
        const Tangents tangents = tangents_at(four.keys, four.shapes, frame);
        CHECK(glm::length(speed_at(four, frame, kStep) - tangents.out) < 1e-5);
        CHECK(glm::length(speed_at(four, frame, -kStep) - tangents.in) < 1e-5);
        if (handles == HandleKind::Free) {
          CHECK(glm::length(tangents.in + tangents.out) < 1e-15);
        }
      }
    }
}

TEST_CASE("key curve: at aligned and automatic keys the speed does not jump, at free keys it does") {
  constexpr double kStep = 1e-5;
  for (unsigned seed = 30; seed <= 50; ++seed)
    for (const auto& [handles, jumps] : {std::pair{HandleKind::Automatic, false},
                                         {HandleKind::Clamped, false},
                                         {HandleKind::Aligned, false},
                                         {HandleKind::Flat, false},
                                         {HandleKind::Free, true}}) {
      const FourKeys four = four_keys(seed, handles);
      for (const int frame : {10, 17}) {
        const double jump = glm::length(speed_at(four, frame, kStep) - speed_at(four, frame, -kStep));
        CHECK((jump > 1e-3) == jumps);
      }
    }
}

TEST_CASE("key curve: linear spans are the slerp, and so is a Bezier span with the slerp's speeds") {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const glm::dquat a = random.rotation(), b = random.rotation();
    const std::map<int, glm::dquat> keys{{4, a}, {11, b}};
    const glm::dvec3 speed = turn_between(a, b) / 7.0;
    for (int frame = 4; frame <= 11; ++frame) {
      const double share = (frame - 4) / 7.0;
      const glm::dquat slerp = glm::normalize(glm::slerp(a, b, share));
      if (frame > 4 && frame < 11) {
        CHECK(value_at(keys, {}, frame) == slerp);
      }
      CHECK(degrees_apart(bezier_rotation(a, speed, b, speed, 7, share), slerp) < 1e-6);
    }
    CHECK(value_at(keys, {}, -100) == a);
    CHECK(value_at(keys, {}, 100) == b);
  }
}

TEST_CASE("key curve: about one axis the angle is the scalar Bezier curve, for wide swings too") {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double a = random.in(-3, 3), b = a + random.in(-3.1, 3.1), frames = random.in(1, 40);
    const double v0 = random.in(-1, 1) * 4 / frames, v1 = random.in(-1, 1) * 4 / frames;
    for (const double share : {0.0, 0.1, 0.37, 0.5, 0.9, 1.0}) {
      const double angle = scalar_bezier(a, v0, b, v1, frames, share);
      const glm::dquat q = bezier_rotation(about_x(a), {v0, 0, 0}, about_x(b), {v1, 0, 0}, frames, share);
      const glm::dquat wanted = about_x(angle);
      const double sign = glm::dot(q, wanted) < 0 ? -1 : 1;
      for (int k = 0; k < 4; ++k) CHECK(std::abs(sign * q[k] - wanted[k]) < 1e-12);
      const glm::dvec3 p = bezier_shift({a, 2 * a, 0}, {v0, 2 * v0, 0}, {b, 2 * b, 0}, {v1, 2 * v1, 0}, frames, share);
      CHECK(std::abs(p.x - angle) < 1e-12);
      CHECK(std::abs(p.y - 2 * angle) < 1e-12);
    }
  }
}

TEST_CASE("key curve: the parent's frame, the bone's own frame and the signs of quaternions do not matter") {
  Random random(4);
  for (unsigned seed = 60; seed < 80; ++seed)
    for (const HandleKind handles : {HandleKind::Automatic, HandleKind::Clamped, HandleKind::Free}) {
      const FourKeys four = four_keys(seed, handles);
      const glm::dquat left = random.rotation(), right = random.rotation();
      FourKeys moved = four;
      for (auto& [frame, q] : moved.keys) q = (frame == 10 ? -1.0 : 1.0) * (left * q * right);
      for (auto& [frame, shape] : moved.shapes) {
        shape.in = left * shape.in;
        shape.out = left * shape.out;
      }
      for (const double frame : {-2.5, 3.0, 12.0, 16.9, 31.0}) {
        const glm::dquat now = value_at(moved.keys, moved.shapes, frame);
        CHECK(degrees_apart(now, left * value_at(four.keys, four.shapes, frame) * right) < 1e-6);
      }
    }
}

TEST_CASE("key curve: clamped keys do not overshoot, automatic ones do") {
  const auto curve = [](HandleKind handles) {
    FourKeys four;
    for (const auto& [frame, degrees] : {std::pair{0, 0.0}, {5, 1.0}, {20, 60.0}, {30, 60.0}, {40, 20.0}, {60, 90.0}}) {
      four.keys[frame] = about_x(glm::radians(degrees));
      four.shapes[frame] = {Interpolation::Bezier, handles};
    }
    return four;
  };
  const auto angle = [](const FourKeys& four, double frame) {
    const glm::dquat q = value_at(four.keys, four.shapes, frame);
    return glm::degrees(2 * std::atan2(q.x, q.w));
  };
  const FourKeys clamped = curve(HandleKind::Clamped), automatic = curve(HandleKind::Automatic);
  double most = 0;
  for (auto key = clamped.keys.begin(); std::next(key) != clamped.keys.end(); ++key) {
    const double from = angle(clamped, key->first), to = angle(clamped, std::next(key)->first);
    for (double frame = key->first; frame <= std::next(key)->first; frame += 0.25) {
      CHECK(angle(clamped, frame) > std::min(from, to) - 1e-9);
      CHECK(angle(clamped, frame) < std::max(from, to) + 1e-9);
      if (key->first == 20) most = std::max(most, angle(automatic, frame));
    }
  }
  CHECK(most > 61);

  std::map<int, glm::dvec3> shift{{0, {0, 5, 0}}, {10, {20, 5, -3}}, {20, {10, 9, 4}}, {30, {0, 9, 9}}};
  KeyShapes shapes;
  for (const auto& [frame, place] : shift) shapes[frame] = {Interpolation::Bezier, HandleKind::Clamped};
  for (double frame = 0; frame <= 30; frame += 0.25) {
    const glm::dvec3 place = value_at(shift, shapes, frame);
    CHECK(place.x < 20 + 1e-9);
    CHECK(place.y > 5 - 1e-9);
    CHECK(place.y < 9 + 1e-9);
  }
}

TEST_CASE("key curve: a circle through clamped keys keeps going at each of them") {
  // Eight rotation vectors lie on a small circle. Clamping each component by itself would stop one component at four of
  // the keys.
  std::map<int, glm::dquat> keys;
  KeyShapes shapes;
  for (int i = 0; i <= 8; ++i) {
    keys[10 * i] = from_vector(0.01 * glm::dvec3(std::cos(i * kPi / 4), std::sin(i * kPi / 4), 0));
    shapes[10 * i] = {Interpolation::Bezier, HandleKind::Clamped};
  }
  const double round = 0.01 * 2 * kPi / 80;
  for (int i = 1; i < 8; ++i)
    CHECK(glm::length(tangents_at(keys, shapes, 10 * i).out) == doctest::Approx(round).epsilon(0.12));
}

TEST_CASE("key curve: a constant key holds until the next one") {
  Clip clip;
  clip.keys.bones["Arm"] = {{0, about_x(0.1)}, {10, about_x(0.7)}};
  clip.keys.root = {{0, {1, 2, 3}}, {10, {4, 5, 6}}};
  set_shape(clip.keys, "Arm", 0, {.next = Interpolation::Constant});
  set_root_shape(clip.keys, 0, {.next = Interpolation::Constant});
  Armature arm;
  arm.bones = {{"Arm", -1, {0, 0, 30}, {0, 0, 0}}};
  const ClipOnRig on_rig(std::make_shared<const Clip>(clip), std::make_shared<const Armature>(arm));
  CHECK(on_rig.at(9).rotation[0] == about_x(0.1));
  CHECK(on_rig.at(9).root_translation == glm::dvec3(1, 2, 3));
  CHECK(on_rig.at(10).rotation[0] == about_x(0.7));
}

TEST_CASE("key curve: shapes go with their keys, and a new key continues the span") {
  Keys keys;
  keys.bones["Arm"] = {{0, about_x(0)}, {10, about_x(1)}, {20, about_x(2)}};
  set_shape(keys, "Arm", 0, {.next = Interpolation::Bezier});
  const KeyShape free{Interpolation::Bezier, HandleKind::Free, {1, 2, 3}, {4, 5, 6}};
  set_shape(keys, "Arm", 10, free);
  move_keys(keys, {{10, 20}});
  CHECK(shape_at(shapes_of(keys, "Arm"), 20) == free);
  CHECK(shapes_of(keys, "Arm").size() == 2);
  copy_keys(keys, {{20, 30}, {0, 20}});
  CHECK(shape_at(shapes_of(keys, "Arm"), 30) == free);
  CHECK(shape_at(shapes_of(keys, "Arm"), 20) == KeyShape{.next = Interpolation::Bezier});
  scale_tangents(keys, 0.5);
  CHECK(shape_at(shapes_of(keys, "Arm"), 30).out == glm::dvec3(2, 2.5, 3));

  Armature arm;
  arm.bones = {{"Arm", -1, {0, 0, 30}, {0, 0, 0}}};
  insert_key(keys, arm, rest_pose(arm), {0}, 5);
  CHECK(shape_at(shapes_of(keys, "Arm"), 5) == KeyShape{.next = Interpolation::Bezier});
  CHECK(keys.root_shapes.empty());
  insert_key(keys, arm, rest_pose(arm), {0}, 30);
  CHECK(shape_at(shapes_of(keys, "Arm"), 30).handles == HandleKind::Free);
  delete_keys(keys, {0, 5, 20, 30});
  CHECK(keys.empty());
  CHECK(keys.shapes.empty());
}

TEST_CASE("key curve: over a motion the curve acts on the correction of the motion") {
  Armature arm;
  arm.bones = {{"Arm", -1, {0, 0, 0}, {0, 0, -30}}};
  Motion motion;
  motion.joints = {{.name = "Arm", .channels = {BvhChannel::Xrotation}, .end_site = glm::dvec3(0, 0, -30)}};
  motion.channel_count = 1;
  motion.frame_count = 61;
  for (int frame = 0; frame <= 60; ++frame) motion.values.push_back(static_cast<float>(20 * std::sin(frame * 0.2)));
  Clip clip = clip_of(std::make_shared<const Motion>(motion), "swing");
  const auto angle = [](const Pose& pose) { return 2 * std::atan2(pose.rotation[0].x, pose.rotation[0].w); };
  const auto at = [&](int frame) {
    return angle(ClipOnRig(std::make_shared<const Clip>(clip), std::make_shared<const Armature>(arm)).at(frame));
  };
  const double base10 = at(10), base20 = at(20), base15 = at(15), base12 = at(12);
  const double a = 0.3, b = -0.2, v0 = 0.05, v1 = 0.02;
  clip.keys.bones["Arm"] = {{10, about_x(base10 + a)}, {20, about_x(base20 + b)}};
  set_shape(clip.keys, "Arm", 10, {Interpolation::Bezier, HandleKind::Free, {0, 0, 0}, {v0, 0, 0}});
  set_shape(clip.keys, "Arm", 20, {Interpolation::Linear, HandleKind::Free, {v1, 0, 0}, {0, 0, 0}});
  CHECK(std::abs(at(10) - base10 - a) < 1e-12);
  CHECK(std::abs(at(12) - base12 - scalar_bezier(a, v0, b, v1, 10, 0.2)) < 1e-12);
  CHECK(std::abs(at(15) - base15 - scalar_bezier(a, v0, b, v1, 10, 0.5)) < 1e-12);
  CHECK(std::abs(at(20) - base20 - b) < 1e-12);
}

}  // namespace limber::test
