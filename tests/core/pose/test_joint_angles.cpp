// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/joint_angles.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/base/error.h"

using namespace limber;

namespace {

JointAngles read(const std::string& request) {
  JointAngles angles;
  add_joint_request(angles, request, "--joint");
  return angles;
}

std::string refusal(const std::string& request) {
  try {
    read(request);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("joint angles: sides, plurals, opposites and cases say the same angle") {
  const JointAngles hip{{{BodyJoint::Hip, BodySide::Left}, {90.0, std::nullopt, std::nullopt}}};
  CHECK(read("left hip flexion=90") == hip);
  CHECK(read("Left Hip Flexion = +90") == hip);
  CHECK(read("L_hip-flexion=90") == hip);
  CHECK(read("left hip extension=-90") == hip);
  CHECK(read("hips flexion=90").size() == 2);
  CHECK(read("both hip flexion=90") == read("hips flexion=90"));
  CHECK(read("left knee=30") == read("left knee flexion=30"));
  CHECK(*read("right shoulder external rotation=20").begin()->second[2] == -20);
  CHECK(*read("right ankle plantarflexion=20").begin()->second[0] == -20);
  CHECK(*read("neck left bending=20").begin()->second[1] == -20);
  CHECK(*read("spine left rotation=20").begin()->second[2] == 20);
}

TEST_CASE("joint angles: a joint's later request replaces the motion that it names and no other") {
  JointAngles angles = read("left hip flexion=90");
  add_joint_request(angles, "left hip abduction=20", "--joint");
  add_joint_request(angles, "left hip flexion=60", "--joint");
  CHECK(angles.at({BodyJoint::Hip, BodySide::Left}) == JointMotions{60.0, 20.0, std::nullopt});
}

TEST_CASE("joint angles: a hand curls all its fingers, one finger bends in all its joints or in one") {
  CHECK(read("left hand curl=60").size() == 5);
  CHECK(read("hands curl=60").size() == 10);
  CHECK(read("left index flexion=60").at({BodyJoint::Index, BodySide::Left}) == JointMotions{60.0, 60.0, 40.0});
  CHECK(read("left index finger pip flexion=60").at({BodyJoint::Index, BodySide::Left}) ==
        JointMotions{std::nullopt, 60.0, std::nullopt});
  CHECK(read("right thumb flexion=30").at({BodyJoint::Thumb, BodySide::Right}) ==
        JointMotions{std::nullopt, 30.0, 30.0});
}

TEST_CASE("joint angles: what is not understood is refused in one line that lists what is known") {
  CHECK(refusal("left hipp flexion=90").find("spine, neck, shoulder girdle, shoulder, elbow") != std::string::npos);
  CHECK(refusal("left hip curl=90")
            .find("flexion, extension, abduction, adduction, internal rotation, external rotation") !=
        std::string::npos);
  CHECK(refusal("left hip=90").find("several motions") != std::string::npos);
  CHECK(refusal("left hip 2 flexion=90").find("no motion") != std::string::npos);
  CHECK(refusal("left spine flexion=90").find("one spine only") != std::string::npos);
  for (const char* number : {"", "nan", "inf", "-inf", "1e400", "9x", "90 90", "361", "=", "0x10"})
    CHECK_MESSAGE(refusal("left hip flexion=" + std::string(number)).find("this is not the angle") != std::string::npos,
                  number);
  for (const char* request : {"left hip flexion", "=90", "", "left=90", "left hip"}) {
    const std::string line = refusal(request);
    CHECK_MESSAGE(!line.empty(), request);
    CHECK(line.find('\n') == std::string::npos);
  }
}

TEST_CASE("joint angles: what adults do not reach is told, by its word and its range") {
  CHECK(beyond_usual(read("left knee flexion=120")).empty());
  const auto lines = beyond_usual(read("left knee flexion=200"));
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].find("left knee flexion of 200 degrees is beyond the -10 to 150") != std::string::npos);
}

TEST_CASE("joint angles: any text is understood or refused in one line, never more") {
  const std::vector<std::vector<std::string>> slots = {{"left", "right", "both", "", "", "l"},
                                                       {"hip", "knees", "hand", "index", "spine", "neck", "toes"},
                                                       {"flexion", "curl", "abduction", "left bending", "", "\xc3\xa9"},
                                                       {"=", "=", "=", "==", " ", std::string(1, '\0')},
                                                       {"90", "-5.5", "nan", "1e308", "\n", "", "+30"}};
  std::uint32_t state = 7;
  int understood = 0, refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text;
    for (const auto& slot : slots) {
      state = state * 1664525u + 1013904223u;
      text += slot[(state >> 16) % slot.size()];
      if ((state >> 8) % 4) text += ' ';
    }
    try {
      for (const auto& [joint, motions] : read(text))
        for (const auto& motion : motions) REQUIRE((!motion || std::abs(*motion) <= 360));
      ++understood;
    } catch (const Error& error) {
      REQUIRE(std::string(error.what()).find('\n') == std::string::npos);
      ++refused;
    }
  }
  CHECK(understood > 500);
  CHECK(refused > 500);
}
