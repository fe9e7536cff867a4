// SPDX-License-Identifier: AGPL-3.0-or-later
// A quality gate (a test that a posed volume passes or fails, quality_gates.h), and the limits by which gates are
// judged.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace limber {

struct QualityLimits {
  double tissue_percent = 1;
  // In voxels; smaller tissues are not judged, since resampling changes them by up to 2 %.
  std::int64_t least_voxels = 5000;
  // Largest deviation of a bone from a rigid motion, mm: 1/40 of the edge of a 2 mm voxel.
  double bone_residual_mm = 0.05;
  double skin_share_percent = 0.2;  // largest allowed loss of skin, in percent of the surface
  double joint_excess_degrees = 0.1;
  // Limits of the body gates:
  double wrong_bone_percent = 0.1;  // largest percentage of a bone's voxels that may follow a wrong rig bone
  double direction_degrees = 1;
  double exposed_percent = 0.1;  // largest percentage of the posed surface that may be newly exposed
  double trapped_voxels = 50;
  double organ_percent = 10;
  double lost_percent = 50;  // a label must keep at least this percentage of its volume
  std::int64_t least_organ_voxels = 200;
  double body_percent = 2;
  double limb_percent = 5;  // replaces body_percent if the body is a single limb, where a bent joint is a large part
};

enum class GateState { Passed, Failed, NotMeasured };

struct QualityGate {
  std::string id;    // one of the ids in quality_gates.h
  std::string name;  // name that the user sees: "Each tissue within 1 %"
  GateState state = GateState::NotMeasured;
  std::string figure;    // measured figure: "-0.30 %", "3 286 voxels"; empty where nothing was measured
  std::string worst;     // the tissue or bone with the worst figure; empty: none
  std::string meaning;   // a sentence that says what is measured
  std::string sentence;  // a sentence with the measured figure, or with the reason for which nothing was measured
  std::string limit;     // limit of the figure: "at most 0.1 %"
  bool strict = false;   // true: a command with --strict fails if this gate fails
};
std::string_view to_string(GateState state);  // returns "passed", "failed" or "not checked"

}  // namespace limber
