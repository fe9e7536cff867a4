// SPDX-License-Identifier: AGPL-3.0-or-later
// A quality gate (quality_gates.h lists them), and the limits by which gates are judged.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace limber {

struct QualityLimits {
  double tissue_percent = 1;
  std::int64_t least_voxels = 5000;  // smaller tissues change by up to 2 % by resampling alone
  double bone_residual_mm = 0.05;    // 0.05 mm is a fortieth of the edge of a voxel of 2 mm
  double skin_share_percent = 0.2;   // percent of the surface that may lose its skin
  double joint_excess_degrees = 0.1;
  // Limits of the body gates:
  double wrong_bone_percent = 0.1;  // percent of a bone's voxels that may be wrong
  double direction_degrees = 1;
  double exposed_percent = 0.1;  // percent of the posed surface that may be newly exposed
  double trapped_voxels = 50;
  double organ_percent = 10;
  double lost_percent = 50;  // percent of a label's volume that must be left
  std::int64_t least_organ_voxels = 200;
  double body_percent = 2;
  double limb_percent = 5;  // replaces body_percent for a single limb, of which one bent joint is a large part
};

enum class GateState { Passed, Failed, NotMeasured };

struct QualityGate {
  std::string id;    // one of the ids in quality_gates.h
  std::string name;  // "Each tissue within 1 %"
  GateState state = GateState::NotMeasured;
  std::string figure;    // "-0.30 %", "3 286 voxels"; empty where nothing was measured
  std::string worst;     // the tissue or bone with the worst figure; empty: none
  std::string meaning;   // a sentence that says what is measured
  std::string sentence;  // a sentence with the measured figure, or with the reason for which nothing was measured
  std::string limit;     // "at most 0.1 %"
  bool strict = false;   // true: a command with --strict fails where this gate fails
};
std::string_view to_string(GateState state);  // "passed", "failed", "not checked"

}  // namespace limber
