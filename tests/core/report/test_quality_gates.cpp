// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/quality_gates.h"

#include <doctest/doctest.h>

#include "core/report/report.h"
#include "core/report/solve_gates.h"
#include "core/rig/pose.h"

using namespace limber;

namespace {

QualityGate gate(const std::string& report, const std::string& id) {
  for (const QualityGate& one : all_gates(report))
    if (one.id == id) return one;
  FAIL("no gate " << id);
  return {};
}

}  // namespace

TEST_CASE("quality gates: what a report has no figures for is neither passed nor failed") {
  for (const char* report : {"", "no report", "[1, 2]", "{}",
                             R"({"tissues": 3, "bones": {"a": 1}, "mesh": [], "total": null, "joints": "x"})"}) {
    INFO(std::string(report));
    CHECK(body_gates(report).size() == 11);
    CHECK(quality_gates(report).size() == 7);
    CHECK(solve_gates(report).size() == 2);
    CHECK(all_gates(report).size() == 20);
    for (const QualityGate& one : all_gates(report)) {
      CHECK(one.sentence.starts_with("\"" + one.name + "\" is not checked: "));
      CHECK(to_string(one.state) == "not checked");
      CHECK(one.state == GateState::NotMeasured);
      CHECK(one.figure.empty());
      CHECK_FALSE(one.name.empty());
      CHECK_FALSE(one.meaning.empty());
    }
  }
}

TEST_CASE(
    "quality gates: tissues are judged by the one of 5 000 voxels or more that changed most, and small ones where none "
    "is large") {
  const std::string report =
      R"({"tissues": [{"name": "Nerve", "label": 1, "voxels_before": 900, "volume_change_percent": 7.5},
    {"name": "Fat", "label": 2, "voxels_before": 50000, "volume_change_percent": 0.2}, {"name": "Skin", "label": 3,
      "voxels_before": 5000, "volume_change_percent": CHANGE}]})";
  const auto with = [&](const char* change) {
    return gate(std::string(report).replace(report.find("CHANGE"), 6, change), "tissues");
  };
  CHECK(with("-0.99").state == GateState::Passed);
  CHECK(with("-0.99").worst == "Skin");
  CHECK(with("-1.01").state == GateState::Failed);
  CHECK(with("-1.01").figure == "-1.01 %");
  CHECK(with("0.1").worst == "Fat");
  const QualityGate small = gate(
      R"({"tissues": [{"name": "Nerve", "voxels_before": 900, "volume_change_percent": 7.5}, {"name": "Nail",
        "voxels_before": 9, "volume_change_percent": -8}]})",
      "tissues");
  CHECK(small.state == GateState::Failed);
  CHECK(small.worst == "Nail");
}

TEST_CASE("quality gates: each fails just beyond its limit, with its figure") {
  struct Case {
    const char *id, *passing, *failing, *figure;
  };
  const Case kCases[] = {
      {"inputs", R"({"doubts": []})", R"({"doubts": ["the rig lies outside the body"]})", "1 doubt"},
      {"whole", R"({"whole_bones": [{"name": "Left femur", "residual_mm": 0.049}]})",
       R"({"whole_bones": [{"name": "Left femur", "residual_mm": 82}, {"name": "Rib", "residual_mm": 0}]})",
       "82.000 mm"},
      {"whole",
       R"({"tissues": [{"mm3_before": 2700, "voxels_before": 100}], "whole_bones": [{"name": "Left femur",
         "residual_mm": 1.49}]})",
       R"({"tissues": [{"mm3_before": 2700, "voxels_before": 100}], "whole_bones": [{"name": "Left femur",
         "residual_mm": 1.51}]})",
       "1.510 mm"},
      {"follows", R"({"whole_bones": [{"name": "Left femur", "voxels": 1000, "wrong_voxels": 1}]})",
       R"({"whole_bones": [{"name": "Left femur", "voxels": 1000, "wrong_voxels": 2, "went_with": "Pelvis",
         "belongs_to": "LeftThigh"}]})",
       "0.20 %"},
      {"directions", R"({"limbs": [{"bone": "LeftThigh", "direction_off_degrees": 0.99}]})",
       R"({"limbs": [{"bone": "LeftThigh", "direction_off_degrees": 1.01}]})", "1.01\u00b0"},
      {"exposed", R"({"exposure": {"voxels": 9, "percent": 0.09, "by_label": [{"name": "muscle", "voxels": 9}]}})",
       R"({"exposure": {"voxels": 11, "percent": 0.11}})", "0.11 %"},
      {"trapped", R"({"total": {"trapped_air_voxels": 50}})", R"({"total": {"trapped_air_voxels": 51}})", "51 voxels"},
      {"organs",
       R"({"tissues": [{"name": "Bladder", "kind": "organ", "voxels_before": 200, "volume_change_percent": -9.9},
         {"name": "Duct", "kind": "organ", "voxels_before": 199, "volume_change_percent": -90}]})",
       R"({"tissues": [{"name": "Bladder", "kind": "organ", "voxels_before": 200, "volume_change_percent": -10.1}]})",
       "-10.1 %"},
      {"lost", R"({"tissues": [{"name": "Testis", "voxels_before": 200, "volume_change_percent": -50}]})",
       R"({"tissues": [{"name": "Testis", "voxels_before": 200, "volume_change_percent": -98}]})", "2 %"},
      {"torn", R"({"tissues": [{"name": "Muscle", "torn_parts": 0}]})",
       R"({"tissues": [{"name": "Muscle", "torn_parts": 1, "components_before": 1, "components_after": 2}]})",
       "1 part"},
      {"bands", R"({"bands": []})",
       R"({"bands": [{"voxels": 300, "stretch": 8.1, "place": [1, 2, 3], "between": ["LeftThigh", "LeftHand"]}]})",
       "1 band"},
      {"volume", R"({"total": {"volume_change_percent": -2}})", R"({"total": {"volume_change_percent": 2.1}})",
       "+2.10 %"},
      {"volume", R"({"whole_body": false, "total": {"volume_change_percent": -4.9}})",
       R"({"whole_body": true, "total": {"volume_change_percent": -4.9}})", "-4.90 %"},
      {"bones", R"({"bones": [{"name": "Fore", "rigid_residual_mm": 0.05}]})",
       R"({"bones": [{"name": "Up", "rigid_residual_mm": 0}, {"name": "Fore", "rigid_residual_mm": 0.051}]})",
       "0.051 mm"},
      {"skin", R"({"skin": {"surface_share_before": 0.87, "surface_share_after": 0.8681}})",
       R"({"skin": {"surface_share_before": 0.87, "surface_share_after": 0.866}})", "86.6 %"},
      {"islands",
       R"({"total": {"new_hole_voxels": 0}, "tissues": [{"name": "Fat", "components_before": 5,
         "components_after": 4}]})",
       R"({"total": {"new_hole_voxels": 3286}, "tissues": [{"name": "Fat", "components_before": 1,
         "components_after": 2}]})",
       "1 island, 3 286 holes"},
      {"islands", R"({"total": {"new_hole_voxels": 0, "dropped_voxels": 0}})",
       R"({"total": {"new_hole_voxels": 0, "dropped_voxels": 1}})", "1 voxel lost"},
      {"reached", R"({"solve": {"converged": true, "reached": 1}})",
       R"({"solve": {"converged": false, "reached": 0.999}})", "99 %"},
      {"reached", R"({"solve": {"converged": true, "reached": 1}})", R"({"solve": {"converged": false, "reached": 1}})",
       "100 %, not converged"},
      {"gap", R"({"mesh": {"min_gap_mm": 0.001}})", R"({"mesh": {"min_gap_mm": 0}})", "0.000 mm"},
      {"inverted", R"({"mesh": {"inverted": 0}})", R"({"mesh": {"inverted": 2}})", "2"},
      {"crossings", R"({"mesh": {"self_intersections": 0}, "total": {"overlap_voxels": 0}})",
       R"({"mesh": {"self_intersections": 1}})", "1 pair"},
      {"crossings", R"({"total": {"overlap_voxels": 0}})",
       R"({"mesh": {"self_intersections": 1}, "total": {"overlap_voxels": 12345678}})", "12 345 678 voxels"},
      {"limits", R"({"joints": [{"bone": "Fore", "excess_degrees": 0.09}, {"bone": "Up"}]})",
       R"({"joints": [{"bone": "Fore", "excess_degrees": 1.6}, {"bone": "Up", "excess_degrees": 0.4}]})", "+1.6\u00b0"},
  };
  for (const Case& one : kCases) {
    INFO(one.id, ": ", one.failing);
    CHECK(gate(one.passing, one.id).state == GateState::Passed);
    CHECK_FALSE(gate(one.passing, one.id).figure.empty());
    CHECK(gate(one.failing, one.id).state == GateState::Failed);
    CHECK(gate(one.failing, one.id).figure == one.figure);
    for (const char* report : {one.passing, one.failing}) {
      CHECK(gate(report, one.id).sentence.ends_with("."));
      CHECK(gate(report, one.id).sentence.find("not checked") == std::string::npos);
    }
  }
}

TEST_CASE("quality gates: a label in pieces is torn, but for bones whose every voxel was followed") {
  const std::string torn =
      R"("tissues": [{"name": "Hand bones", "label": 7, "torn_parts": 2, "components_before": 2,
        "components_after": 4}])";
  CHECK(gate("{" + torn + "}", "torn").state == GateState::Failed);
  CHECK(gate("{" + torn + R"(, "whole_bones": [{"label": 8}]})", "torn").state == GateState::Failed);
  CHECK(gate("{" + torn + R"(, "whole_bones": [{"label": 7}]})", "torn").state == GateState::NotMeasured);
}

TEST_CASE("quality gates: a report in hand is judged as its file is, and limits of a rig as those of its report") {
  Report report;
  report.deform.emplace();
  report.deform->new_hole_voxels = 2;
  report.deform->bones = {{"Fore", 0.2, 100}};
  const auto gates = quality_gates(report);
  CHECK(gates[1].state == GateState::Failed);
  CHECK(gates[1].worst == "Fore");
  CHECK(gates[3].figure == "2 holes");

  Armature rig;
  rig.bones.push_back({.name = "Up", .parent = -1, .head = {0, 0, 0}, .tail = {0, 0, 100}});
  rig.bones.push_back({.name = "Fore", .parent = 0, .head = {0, 0, 100}, .tail = {0, 0, 200}});
  rig.bones[1].limits.type = JointLimits::Type::Hinge;
  rig.bones[1].limits.axis = {1, 0, 0};
  rig.bones[1].limits.minimum = 0;
  rig.bones[1].limits.maximum = glm::radians(90.0);
  Pose pose = rest_pose(rig);
  pose.rotation[1] = glm::angleAxis(glm::radians(90.0), glm::dvec3(1, 0, 0));
  CHECK(judge_joint_limits(rig, pose).state == GateState::Passed);
  pose.rotation[1] = glm::angleAxis(glm::radians(92.5), glm::dvec3(1, 0, 0));
  const QualityGate beyond = judge_joint_limits(rig, pose);
  CHECK(beyond.state == GateState::Failed);
  CHECK(beyond.worst == "Fore");
  CHECK(beyond.figure == "+2.5\u00b0");
}

TEST_CASE("quality gates: joints without limits are not within them") {
  const QualityGate none = gate(R"({"joints": [{"bone": "Fore"}, {"bone": "Up"}]})", "limits");
  CHECK(none.state == GateState::NotMeasured);
  CHECK(none.sentence == "\"Joint limits\" is not checked: no joint has limits.");
  CHECK(gate(R"({"joints": []})", "limits").state == GateState::NotMeasured);
  const QualityGate some = gate(R"({"joints": [{"bone": "Fore", "excess_degrees": 0}, {"bone": "Up"}]})", "limits");
  CHECK(some.state == GateState::Passed);
  CHECK(some.sentence == "Every joint that has limits is within them; 1 joint has none.");

  Armature rig;
  rig.bones.push_back({.name = "Up", .parent = -1, .head = {0, 0, 0}, .tail = {0, 0, 100}});
  rig.bones.push_back({.name = "Fore", .parent = 0, .head = {0, 0, 100}, .tail = {0, 0, 200}});
  CHECK(judge_joint_limits(rig, rest_pose(rig)).state == GateState::NotMeasured);
  CHECK(judge_joint_limits(rig, rest_pose(rig)).figure.empty());
}
