// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares directions of posed limbs with clinical definitions that are written down by hand for each pose.
#include "core/pose/body_poses.h"

#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/rig_io/rig_io.h"
#include "tests/support/body_rig.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

const glm::dvec3 kLeft(1, 0, 0), kFront(0, -1, 0), kUpwards(0, 0, 1);

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

Pose posed(const Armature& rig, const std::string& name, const std::vector<std::string>& joints = {}) {
  std::vector<std::string> warnings;
  return with_request(rig, rest_pose(rig), {name, joints}, warnings);
}

// Returns the direction of a limb (side: +1 left, -1 right) raised by `forward` degrees to the front, then `out` aside.
glm::dvec3 hanging(double forward, double out, double side) {
  const double f = glm::radians(forward), a = glm::radians(out);
  return side * std::sin(a) * kLeft + std::cos(a) * (std::sin(f) * kFront - std::cos(f) * kUpwards);
}

glm::dvec3 between(const Armature& rig, const Pose& pose, const std::string& from, const std::string& to) {
  const auto world = posed_from_rest(rig, pose);
  const auto a = static_cast<std::size_t>(require_bone(rig, from)), b = static_cast<std::size_t>(require_bone(rig, to));
  return glm::normalize(world[b] * rig.bones[b].head - world[a] * rig.bones[a].head);
}

struct Body {
  RigNames names;
  Armature rig;
  glm::dquat lies{1, 0, 0, 0};  // rotation of the whole body from upright

  std::string sided(const std::string& name, double side) const {
    return all_replaced(name, "@", side > 0 ? names.left : names.right);
  }
  glm::dvec3 along(const Pose& pose, const std::string& from, const std::string& to, double side) const {
    return glm::conjugate(lies) * between(rig, pose, sided(from, side), sided(to, side));
  }
};

// Checks the direction of each limb in each named pose.
void check_poses(const Body& body, double tolerance = 0.1) {
  for (const double side : {1.0, -1.0}) {
    const auto thigh = [&](const Pose& pose) { return body.along(pose, body.names.thigh, body.names.shank, side); };
    const auto shank = [&](const Pose& pose) { return body.along(pose, body.names.shank, body.names.foot, side); };
    const auto upper = [&](const Pose& pose) {
      return body.along(pose, body.names.upper_arm, body.names.forearm, side);
    };
    const auto fore = [&](const Pose& pose) { return body.along(pose, body.names.forearm, body.names.hand, side); };
    const auto near = [&](const glm::dvec3& direction, const glm::dvec3& demanded, const char* what) {
      CHECK_MESSAGE(degrees_between(direction, demanded) < tolerance, what, side);
    };
    const Pose sit = posed(body.rig, "sit");
    near(thigh(sit), hanging(90, 5, side), "sit, thigh level, a little apart");
    near(shank(sit), -kUpwards, "sit, shank down");
    near(upper(sit), hanging(10, 10, side), "sit, upper arm");
    CHECK(degrees_between(upper(sit), fore(sit)) == doctest::Approx(80));
    CHECK(glm::dot(fore(sit), kFront) > 0.9);

    const Pose squat = posed(body.rig, "squat");
    near(thigh(squat), hanging(110, 15, side), "squat, thigh");
    CHECK(degrees_between(thigh(squat), shank(squat)) == doctest::Approx(120));
    CHECK(glm::dot(shank(squat), kUpwards) < -0.9);

    const Pose walk = posed(body.rig, "walk");
    near(thigh(walk), hanging(side > 0 ? -12 : 25, 0, side), "walk, thigh");
    near(shank(walk), hanging(side > 0 ? -27 : 20, 0, side), "walk, shank");
    near(upper(walk), hanging(side > 0 ? 25 : -20, 8, side), "walk, upper arm");

    near(upper(posed(body.rig, "T")), side * kLeft, "T, upper arm");
    near(fore(posed(body.rig, "T")), side * kLeft, "T, forearm");
    near(fore(posed(body.rig, "A")), hanging(0, 45, side), "A, forearm");
    near(upper(posed(body.rig, "supine")), hanging(0, 15, side), "supine, upper arm");
    near(thigh(posed(body.rig, "supine")), -kUpwards, "supine, thigh");
    near(upper(posed(body.rig, "arms-up")), hanging(0, 160, side), "arms-up, upper arm");
    near(shank(posed(body.rig, "stand")), -kUpwards, "stand, shank");
    if (side < 0) near(upper(posed(body.rig, "reach")), hanging(135, 0, side), "reach, upper arm");
  }
}

Body body_of(const RigNames& names, const std::vector<HandTurn>& turns = {}) {
  return {names, rested(body_rig(names), turns)};
}

// Returns rotations of bones, named as in kAnatomistsNames, that raise the hanging arms by `abduction` and turn the
// palms by `palms` (degrees). The turned body becomes the rest pose; 90 and 90 degrees give a T-pose.
std::vector<HandTurn> t_pose(double abduction, double palms) {
  return {{"LeftUpperArm", {0, 1, 0}, -abduction},
          {"RightUpperArm", {0, 1, 0}, abduction},
          {"LeftForearm", {0, 0, 1}, -palms},
          {"RightForearm", {0, 0, 1}, palms}};
}

}  // namespace

TEST_CASE(
    "body poses: a straight body in the anatomical position takes every pose by its definition, whatever its bones are "
    "called") {
  for (const RigNames& names : {kAnatomistsNames, kMixamoNames, kBlenderNames, kUnrealNames}) {
    CAPTURE(names.thigh);
    check_poses(body_of(names));
  }
}

TEST_CASE("body poses: T-pose, A-pose, seated and crooked rests give the same body as hanging arms do") {
  const std::vector<std::vector<HandTurn>> rests = {t_pose(90, 90),
                                                    t_pose(45, 90),
                                                    t_pose(90, 0),
                                                    t_pose(0, 90),
                                                    t_pose(170, 0),
                                                    {{"LeftThigh", {1, 0, 0}, -90},
                                                     {"RightThigh", {1, 0, 0}, -90},
                                                     {"LeftShank", {1, 0, 0}, 90},
                                                     {"RightShank", {1, 0, 0}, 90}},
                                                    {{"LeftThigh", {0, 1, 0}, -30},
                                                     {"RightThigh", {0, 1, 0}, 20},
                                                     {"LeftForearm", {1, 0, 0}, -60},
                                                     {"RightForearm", {1, 0, 0}, -100},
                                                     {"LeftFoot", {1, 0, 0}, 30}},
                                                    {{"LeftThigh", {1, 0, 0}, -50}},
                                                    {{"LeftThigh", {0, 0, 1}, 40},
                                                     {"RightThigh", {0, 0, 1}, -40},
                                                     {"LeftUpperArm", {0, 0, 1}, 30},
                                                     {"LeftShank", {1, 0, 0}, 10}}};
  for (const auto& rest : rests) {
    CAPTURE(rest.front().bone);
    CAPTURE(rest.front().degrees);
    check_poses(body_of(kAnatomistsNames, rest));
  }
}

TEST_CASE("body poses: palms, soles and knees face the same way from every rest") {
  const auto facing = [](const std::vector<HandTurn>& rest, const std::string& pose_name) {
    const Armature upright = body_rig(), rig = rested(upright, rest);
    const Pose pose = posed(rig, pose_name);
    const auto world = posed_from_rest(rig, pose);
    std::map<std::string, glm::dvec3> directions;
    for (const char* side : {"Left", "Right"}) {
      const std::string s = side;
      directions[s + " palm"] = between(rig, pose, s + "HandIndex1", s + "HandLittle1");
      directions[s + " foot"] = between(rig, pose, s + "Foot", s + "Toes");
      directions[s + " finger"] = between(rig, pose, s + "HandMiddle1", s + "HandMiddle2");
    }
    return directions;
  };
  for (const std::string name : {"sit", "T", "supine", "phone", "drive"}) {
    const auto expected = facing({}, name);
    for (const auto& rest : {t_pose(90, 90), t_pose(45, 60), t_pose(0, 120)})
      for (const auto& [what, direction] : facing(rest, name))
        CHECK_MESSAGE(degrees_between(direction, expected.at(what)) < 0.1, name, what);
    std::vector<HandTurn> seated{{"LeftThigh", {1, 0, 0}, -90},
                                 {"LeftShank", {1, 0, 0}, 90},
                                 {"LeftFoot", {1, 0, 0}, 25},
                                 {"RightFoot", {1, 0, 0}, -10}};
    for (const auto& [what, direction] : facing(seated, name))
      CHECK_MESSAGE(degrees_between(direction, expected.at(what)) < 0.1, name, what);
  }
  // The palms face as the pose names say: down, forward, towards the body.
  const auto t = facing({}, "T"), supine = facing({}, "supine");
  CHECK(degrees_between(t.at("Left palm"), -kFront) < 0.1);
  CHECK(degrees_between(t.at("Right palm"), -kFront) < 0.1);
  CHECK(degrees_between(supine.at("Left palm"),
                        -std::cos(glm::radians(15.0)) * kLeft - std::sin(glm::radians(15.0)) * kUpwards) < 0.1);
}

TEST_CASE("body poses: a body that lies or is turned as a whole takes its poses in its own axes") {
  for (const glm::dquat& turn :
       {glm::angleAxis(glm::radians(-90.0), kLeft), glm::angleAxis(glm::radians(180.0), kUpwards),
        glm::angleAxis(glm::radians(37.0), glm::normalize(glm::dvec3(1, 2, 3)))}) {
    Body body{kAnatomistsNames, moved(body_rig(), turn, {100, -50, 30}), turn};
    check_poses(body);
    body.rig = moved(rested(body_rig(), t_pose(90, 90)), turn, {0, 0, 0});
    check_poses(body);
  }
}

TEST_CASE(
    "body poses: joints that are a little off do not turn an upright body, one that lies askew keeps its own axes") {
  Body leaning{kAnatomistsNames, body_rig()};
  for (Bone& bone : leaning.rig.bones) {
    // Moves the neck back and the left hip forward.
    const bool neck = bone.name == "Neck" || bone.name == "Head", hip = bone.name == "LeftThigh";
    if (neck) bone.head.y += 35, bone.tail.y += 35;
    if (hip) bone.head.y -= 12;
  }
  check_poses(leaning);
  const glm::dquat askew = glm::angleAxis(glm::radians(11.0), kUpwards);
  check_poses({kAnatomistsNames, moved(body_rig(), askew, {0, 0, 0}), askew});
}

TEST_CASE("body poses: the roll of bones and hands without fingers change no direction") {
  Body body{kAnatomistsNames, body_rig(kAnatomistsNames, false)};
  for (std::size_t b = 0; b < body.rig.bones.size(); ++b) body.rig.bones[b].roll = 0.7 * static_cast<double>(b);
  check_poses(body);
}

TEST_CASE("body poses: joints bend the way that their words say, on both sides, straight as they are") {
  const Armature rig = body_rig();
  const auto at = [&](const std::string& joint, const std::string& from, const std::string& to) {
    return between(rig, posed(rig, "", {joint}), from, to);
  };
  const auto near = [](const glm::dvec3& direction, const glm::dvec3& demanded) {
    CHECK(degrees_between(direction, demanded) < 0.01);
  };
  for (const double side : {1.0, -1.0}) {
    const std::string word = side > 0 ? "left " : "right ", s = side > 0 ? "Left" : "Right";
    const glm::dvec3 out = side * kLeft;
    near(at(word + "hip flexion=90", s + "Thigh", s + "Shank"), kFront);
    near(at(word + "hip extension=20", s + "Thigh", s + "Shank"), hanging(-20, 0, side));
    near(at(word + "hip abduction=30", s + "Thigh", s + "Shank"), hanging(0, 30, side));
    near(at(word + "hip adduction=10", s + "Thigh", s + "Shank"), hanging(0, -10, side));
    near(at(word + "knee flexion=90", s + "Shank", s + "Foot"), -kFront);
    near(at(word + "elbow flexion=90", s + "Forearm", s + "Hand"), kFront);
    near(at(word + "shoulder abduction=90", s + "UpperArm", s + "Forearm"), out);
    near(at(word + "wrist flexion=90", s + "HandMiddle1", s + "HandMiddle2"), kFront);
    near(at(word + "wrist extension=60", s + "HandMiddle1", s + "HandMiddle2"), hanging(-60, 0, side));
    near(at(word + "wrist ulnar deviation=30", s + "HandMiddle1", s + "HandMiddle2"), hanging(0, -30, side));
    near(at(word + "index flexion=90", s + "HandIndex1", s + "HandIndex2"), kFront);
    near(at(word + "index flexion=90", s + "HandIndex2", s + "HandIndex3"), kUpwards);
    near(at(word + "forearm pronation=90", s + "HandIndex1", s + "HandLittle1"), -kFront);
    near(at(word + "forearm pronation=180", s + "HandIndex1", s + "HandLittle1"), out);
    // A rotation about a limb's own axis does not move that limb, but turns the limbs that bend from it.
    const Pose turned =
        posed(rig, "",
              {word + "hip internal rotation=30", word + "shoulder external rotation=90", word + "elbow flexion=90"});
    near(between(rig, turned, s + "Thigh", s + "Shank"), -kUpwards);
    CHECK(glm::dot(between(rig, turned, s + "Foot", s + "Toes"), out) < -0.4);
    near(between(rig, turned, s + "Forearm", s + "Hand"), out);
    // At rest the foot points 25 degrees below level.
    const glm::dvec3 up = at(word + "ankle dorsiflexion=20", s + "Foot", s + "Toes"),
                     flat = at(word + "ankle dorsiflexion=0", s + "Foot", s + "Toes");
    CHECK(degrees_between(up, flat) == doctest::Approx(20));
    CHECK(up.z > flat.z);
    const Pose inverted = posed(rig, "", {word + "ankle inversion=20"});
    CHECK(glm::dot(posed_from_rest(rig, inverted)[static_cast<std::size_t>(require_bone(rig, s + "Foot"))].rotation *
                       -kUpwards,
                   out) < -0.3);
    CHECK(at(word + "shoulder girdle elevation=20", s + "Clavicle", s + "UpperArm").z > 0.2);
    CHECK(at(word + "shoulder girdle upward rotation=20", s + "Clavicle", s + "UpperArm").z > 0.1);
    CHECK(glm::dot(at(word + "shoulder girdle protraction=20", s + "Clavicle", s + "UpperArm") -
                       at(word + "shoulder girdle elevation=0", s + "Clavicle", s + "UpperArm"),
                   kFront) > 0.2);
  }
}

TEST_CASE(
    "body poses: a raised arm takes a sixth of what is beyond 30 degrees from the collarbone, unless its girdle is "
    "named") {
  const Armature rig = body_rig();
  const auto turned = [&](const std::vector<std::string>& joints, const std::string& bone) {
    return posed_from_rest(rig, posed(rig, "", joints))[static_cast<std::size_t>(require_bone(rig, bone))].rotation;
  };
  const auto degrees = [](const glm::dquat& q) { return glm::degrees(2 * std::acos(std::min(1.0, std::abs(q.w)))); };
  CHECK(degrees(turned({"left shoulder abduction=120"}, "LeftClavicle")) == doctest::Approx(15));
  CHECK(degrees(turned({"right shoulder flexion=90"}, "RightClavicle")) == doctest::Approx(10));
  CHECK(degrees(turned({"left shoulder flexion=60", "left shoulder abduction=60"}, "LeftClavicle")) ==
        doctest::Approx((glm::degrees(std::acos(0.25)) - 30) / 6));
  CHECK(degrees(turned({"left shoulder abduction=30"}, "LeftClavicle")) < 1e-6);
  CHECK(degrees(turned({"left shoulder abduction=120", "left shoulder girdle elevation=0"}, "LeftClavicle")) < 1e-6);
  CHECK(degrees(turned({"left shoulder abduction=120"}, "RightClavicle")) < 1e-6);
  // The arm ends where it was asked to. The shoulder blade glides: the normal of its plane does not change.
  for (const auto& [word, s, side] :
       {std::tuple{std::string("left "), std::string("Left"), 1.0}, {"right ", "Right", -1.0}}) {
    const Pose pose = posed(rig, "", {word + "shoulder abduction=120"});
    CHECK(degrees_between(between(rig, pose, s + "UpperArm", s + "Forearm"),
                          glm::dvec3(side * std::sin(glm::radians(120.0)), 0, 0.5)) < 0.01);
    const double blade = glm::radians(35.0);
    const glm::dvec3 square(side * std::sin(blade), std::cos(blade), 0);
    CHECK(degrees_between(turned({word + "shoulder abduction=120"}, s + "Clavicle") * square, square) < 0.01);
    CHECK((turned({word + "shoulder abduction=120"}, s + "Clavicle") * glm::dvec3(side, 0, 0)).z > 0.15);
  }
}

TEST_CASE("body poses: spine and neck share their turn, and the head ends where the whole of it leads") {
  const Armature rig = body_rig();
  const auto top = [&](const std::vector<std::string>& joints, const std::string& bone) {
    return posed_direction(rig, posed(rig, "", joints), bone);
  };
  CHECK(degrees_between(top({"spine flexion=60"}, "Thorax"),
                        glm::dvec3(0, -std::sin(glm::radians(60.0)), std::cos(glm::radians(60.0)))) < 0.01);
  CHECK(degrees_between(top({"spine flexion=60"}, "Lumbar"),
                        glm::dvec3(0, -std::sin(glm::radians(30.0)), std::cos(glm::radians(30.0)))) < 0.01);
  CHECK(degrees_between(top({"neck right bending=30"}, "Head"), glm::dvec3(-0.5, 0, std::sqrt(0.75))) < 0.01);
  const Pose turned = posed(rig, "", {"neck left rotation=60"});
  const glm::dvec3 nose =
      posed_from_rest(rig, turned)[static_cast<std::size_t>(require_bone(rig, "Head"))].rotation * kFront;
  CHECK(degrees_between(nose, glm::dvec3(std::sin(glm::radians(60.0)), -0.5, 0)) < 0.01);
  // The arms move with the trunk, and their angles are relative to it.
  const Pose bent =
      posed(rig, "", {"spine flexion=40", "left shoulder flexion=40", "left shoulder girdle elevation=15"});
  CHECK(degrees_between(between(rig, bent, "LeftUpperArm", "LeftForearm"), -kUpwards) < 0.01);
}

TEST_CASE("body poses: a joint that is not named keeps what it has, to the bit") {
  const Armature rig = rested(body_rig(), t_pose(60, 30));
  Pose base = rest_pose(rig);
  const auto chest = static_cast<std::size_t>(require_bone(rig, "Thorax")),
             knee = static_cast<std::size_t>(require_bone(rig, "LeftShank"));
  base.rotation[chest] = glm::angleAxis(0.3, glm::normalize(glm::dvec3(1, 2, 3)));
  base.rotation[knee] = glm::angleAxis(0.4, kLeft);
  std::vector<std::string> warnings;
  const Pose pose = with_request(rig, base, {"", {"left hip flexion=50"}}, warnings);
  for (std::size_t b = 0; b < rig.bones.size(); ++b)
    if (rig.bones[b].name != "LeftThigh") CHECK(pose.rotation[b] == base.rotation[b]);
  CHECK(with_request(rig, base, {}, warnings) == base);
  CHECK(warnings.empty());
}

TEST_CASE("body poses: a single joint goes over a named pose and keeps the pose's other motions of it") {
  const Armature rig = body_rig();
  const Pose pose = posed(rig, "sit", {"left hip flexion=60", "right elbow flexion=20"});
  CHECK(degrees_between(between(rig, pose, "LeftThigh", "LeftShank"), hanging(60, 5, 1)) < 0.01);
  CHECK(degrees_between(between(rig, pose, "RightThigh", "RightShank"), hanging(90, 5, -1)) < 0.01);
  CHECK(degrees_between(between(rig, pose, "RightUpperArm", "RightForearm"),
                        between(rig, pose, "RightForearm", "RightHand")) == doctest::Approx(20));
}

TEST_CASE("body poses: elbow and forearm are joints of one bone, each keeps the other's turn") {
  const Armature rig = rested(body_rig(), t_pose(90, 90));
  const Pose bent = posed(rig, "", {"left elbow flexion=90"}),
             both = posed(rig, "", {"left elbow flexion=90", "left forearm pronation=90"});
  for (std::size_t b = 0; b < rig.bones.size(); ++b)
    CHECK(std::abs(glm::dot(bent.rotation[b], both.rotation[b])) == doctest::Approx(1));
  const Pose turned = posed(rig, "", {"left forearm pronation=0"});
  CHECK(degrees_between(between(rig, turned, "LeftForearm", "LeftHand"), kLeft) < 0.01);
  CHECK(degrees_between(between(rig, turned, "LeftHandIndex1", "LeftHandLittle1"), -kUpwards) < 0.01);
  // The forearm bone takes half of the pronation.
  CHECK(2 * std::acos(std::min(
                1.0, std::abs(turned.rotation[static_cast<std::size_t>(require_bone(rig, "LeftForearm"))].w))) ==
        doctest::Approx(glm::radians(45.0)));
}

TEST_CASE("body poses: what a rig lacks or cannot tell is refused in one line") {
  const auto refusal = [](const Armature& rig, const std::string& name,
                          const std::vector<std::string>& joints) -> std::string {
    try {
      posed(rig, name, joints);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Armature legs;
  for (const Bone& bone : body_rig().bones)
    if (bone.name == "LeftThigh" || bone.name == "LeftShank") legs.bones.push_back(bone);
  legs.bones[0].parent = -1, legs.bones[1].parent = 0;
  // The root carries the whole body, so turning it would turn everything: the request is refused.
  CHECK(refusal(legs, "", {"left hip flexion=20"}).find("use one of these joints: left knee") != std::string::npos);
  CHECK(refusal(legs, "", {"right knee flexion=20"}).find("no right knee") != std::string::npos);
  CHECK(refusal(legs, "", {"knee flexion=20"}).empty());
  CHECK(refusal(legs, "", {"knees flexion=20"}).empty());
  CHECK(refusal(legs, "sit", {}).empty());
  CHECK(refusal(body_rig(), "", {"knee flexion=20"}).find("left, right or both") != std::string::npos);
  CHECK(refusal(body_rig(), "lie", {}).find("stand, sit, walk, phone, arms-up, squat, drive, supine, reach, T, A") !=
        std::string::npos);
  Armature nameless{{{.name = "Bone", .tail = {0, 0, 10}}}};
  CHECK(refusal(nameless, "sit", {}).find("no joint of the rig's limbs") != std::string::npos);
  CHECK(refusal(nameless, "", {"neck flexion=3"}).find("no bone name of the rig is recognised") != std::string::npos);
}

TEST_CASE(
    "body poses: every row of the table reads, stays within what adults reach and is found by its name in any case") {
  for (const BodyPose& pose : body_poses()) {
    CAPTURE(std::string(pose.name));
    CHECK(beyond_usual(angles_of(pose)).empty());
    CHECK(pose.description.ends_with('.'));
    CHECK(&require_body_pose(std::string(pose.name), "") == &pose);
  }
  CHECK(require_body_pose("ARMS_UP", "").name == "arms-up");
  CHECK(require_body_pose("t", "").name == "T");
}

TEST_CASE("body poses: hinges turn about their own axes only, and what goes beyond the rig's limits is told") {
  Armature rig = rested(body_rig(), {{"LeftShank", {1, 0, 0}, 20}});
  Bone& knee = rig.bones[static_cast<std::size_t>(require_bone(rig, "LeftShank"))];
  knee.limits = {
      .type = JointLimits::Type::Hinge, .axis = glm::normalize(glm::dvec3(1, 0.1, 0)), .minimum = -0.4, .maximum = 1};
  std::vector<std::string> warnings;
  const Pose pose = with_request(rig, rest_pose(rig), {"sit", {}}, warnings);
  const glm::dquat q = pose.rotation[static_cast<std::size_t>(require_bone(rig, "LeftShank"))];
  CHECK(glm::length(glm::cross(glm::dvec3(q.x, q.y, q.z), knee.limits.axis)) < 1e-9);
  CHECK(glm::degrees(2 * std::atan2(glm::dot(glm::dvec3(q.x, q.y, q.z), knee.limits.axis), q.w)) ==
        doctest::Approx(70).epsilon(0.01));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("LeftShank by 12") != std::string::npos);
}

TEST_CASE(
    "body poses: bones without length, a limb without joints below and exchanged sides give a pose of finite turns") {
  Armature rig = body_rig();
  for (Bone& bone : rig.bones)
    if (bone.name == "LeftHand" || bone.name == "LeftToes" || bone.name == "RightFoot" || bone.name == "RightShank")
      bone.tail = bone.head;
  rig.bones[static_cast<std::size_t>(require_bone(rig, "RightFoot"))].head =
      rig.bones[static_cast<std::size_t>(require_bone(rig, "RightShank"))].head;
  std::vector<std::string> warnings;
  for (const BodyPose& named : body_poses())
    for (const glm::dquat& q : with_request(rig, rest_pose(rig), {std::string(named.name), {}}, warnings).rotation)
      CHECK(glm::length(q) == doctest::Approx(1));
  CHECK(warnings.empty());

  Armature exchanged = body_rig();
  for (Bone& bone : exchanged.bones) bone.head.x *= -1, bone.tail.x *= -1;
  with_request(exchanged, rest_pose(exchanged), {"sit", {}}, warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("exchanged") != std::string::npos);
}

TEST_CASE("body poses: with the telephone the right palm is beside the right ear, facing it") {
  NEEDS_SHARED("data/bp3d/body.armature.json");
  const Armature rig = read_armature(shared_path("data/bp3d/body.armature.json"));
  const Pose pose = posed(rig, "phone");
  const auto world = posed_from_rest(rig, pose);
  const auto head_of = [&](const char* bone) {
    const auto b = static_cast<std::size_t>(require_bone(rig, bone));
    return world[b] * rig.bones[b].head;
  };
  // The opening of the ear lies beside the joint between head and neck, a little above it.
  const glm::dvec3 ear = head_of("Head") + glm::dvec3(-78, 0, 15);
  const glm::dvec3 palm = (head_of("RightHand") + head_of("RightMiddleProximal")) / 2.0;
  CHECK(glm::distance(palm, ear) < 60);
  CHECK(palm.x < ear.x);
  const glm::dvec3 along = head_of("RightMiddleProximal") - head_of("RightHand");
  const glm::dvec3 across = head_of("RightLittleProximal") - head_of("RightIndexProximal");
  CHECK(glm::normalize(glm::cross(along, across)).x > 0.8);
}

TEST_CASE("body poses: joints that a named pose has to leave out in the middle of a limb are told") {
  Armature rig = body_rig();
  rig.bones[static_cast<std::size_t>(require_bone(rig, "LeftThigh"))].name = "Stick";
  std::vector<std::string> warnings;
  with_request(rig, rest_pose(rig), {"sit", {}}, warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("left hip") != std::string::npos);
  CHECK(warnings[0].find("right hip") == std::string::npos);
}

TEST_CASE("body poses: a shank that does not hang from its thigh is told") {
  Armature rig = body_rig();
  rig.bones[static_cast<std::size_t>(require_bone(rig, "RightShank"))].parent = 0;
  std::vector<std::string> warnings;
  with_request(rig, rest_pose(rig), {"", {"left hip flexion=30"}}, warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("RightShank from RightThigh") != std::string::npos);
}

TEST_CASE("body poses: the rigs that come with the program, hinges and all, take the poses") {
  for (const char* rig : {"adult", "child"})
    check_poses({kAnatomistsNames, read_armature(std::string(LIMBER_SOURCE_DIR "/assets/rigs/") + rig + ".json")});
}

TEST_CASE("body poses: a hand whose names say no side curls its fingers into its palm") {
  const Armature hand = read_armature(LIMBER_SOURCE_DIR "/assets/rigs/hand.json");
  const Pose straight = posed(hand, "", {"hand curl=0"}), fist = posed(hand, "", {"hand curl=80"});
  // The hand is a right one: its palm faces along the cross product of these two directions.
  const auto place = [&](const char* bone) {
    return hand.bones[static_cast<std::size_t>(require_bone(hand, bone))].head;
  };
  const glm::dvec3 along = place("MiddleProximal") - place("Hand");
  const glm::dvec3 palm = glm::normalize(glm::cross(along, place("LittleProximal") - place("IndexProximal")));
  for (const std::string finger : {"Index", "Middle", "Ring", "Little"}) {
    const glm::dvec3 before = posed_direction(hand, straight, finger + "Proximal"),
                     after = posed_direction(hand, fist, finger + "Proximal");
    CHECK(degrees_between(before, after) == doctest::Approx(80).epsilon(0.01));
    CHECK(glm::dot(after - before, palm) > 0.8);
    CHECK(degrees_between(posed_direction(hand, fist, finger + "Middle"), after) == doctest::Approx(80).epsilon(0.01));
    CHECK(degrees_between(posed_direction(hand, straight, finger + "Middle"), before) < 0.5);
  }
}

TEST_CASE("body poses: real rigs of CT bodies, modellers and scanners take the poses to a hundredth of a degree") {
  NEEDS_SHARED("data/bp3d/body.armature.json");
  NEEDS_SHARED("data/makehuman/body.armature.json");
  NEEDS_SHARED("data/bender/Adult-armature.vtk");
  const RigNames makehuman{"Hips",     "LowerBack", "Spine1", "Neck", "Head",  "@Shoulder", "@Arm",
                           "@ForeArm", "@Hand",     "@UpLeg", "@Leg", "@Foot", "@ToeBase",  ""};
  const RigNames bender{"Root",     "",      "",       "",       "Head",  "@Shoulder", "@Humerus",
                        "@Forearm", "@Hand", "@Femur", "@Tibia", "@Foot", "",          ""};
  for (const auto& [file, names] : {std::pair{"data/bp3d/body.armature.json", kAnatomistsNames},
                                    {"data/makehuman/body.armature.json", makehuman},
                                    {"data/bender/Adult-armature.vtk", bender}}) {
    CAPTURE(file);
    const Body body{names, read_armature(shared_path(file))};
    check_poses(body, 0.01);
    const glm::dquat turn = glm::angleAxis(glm::radians(-90.0), kLeft);
    check_poses({names, moved(body.rig, turn, {0, 0, 0}), turn}, 0.01);
  }
}
