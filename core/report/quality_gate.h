// SPDX-License-Identifier: AGPL-3.0-or-later
// One of the gates that quality_gates.h names, and the limits that it is judged by.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace limber {

struct QualityLimits {
  double tissue_percent = 1;
  std::int64_t least_voxels =
      5000;  // of a tissue at rest: fewer change by up to 2 % when a rigid part alone is sampled anew
  double bone_residual_mm = 0.05;   // a fortieth of a voxel of 2 mm
  double skin_share_percent = 0.2;  // of the surface, that is no longer skin
  double joint_excess_degrees = 0.1;
  // Of the body.
  double wrong_bone_percent = 0.1;  // of a bone's voxels
  double direction_degrees = 1;
  double exposed_percent = 0.1;  // of the posed surface
  double trapped_voxels = 50;
  double organ_percent = 10;
  double lost_percent = 50;  // of a label's volume
  std::int64_t least_organ_voxels = 200;
  double body_percent = 2;
  double limb_percent = 5;  // of a limb alone, of which one bent joint is a good part
};

enum class GateState { Passed, Failed, NotMeasured };

struct QualityGate {
  std::string id;    // as above
  std::string name;  // "Each tissue within 1 %"
  GateState state = GateState::NotMeasured;
  std::string figure;    // "-0.30 %", "3 286 voxels"; empty where nothing was measured
  std::string worst;     // the tissue or bone whose figure that is; empty for none
  std::string meaning;   // a sentence: what is measured
  std::string sentence;  // what came out, and why where nothing did
  std::string limit;     // "at most 0.1 %"
  bool strict = false;   // whether a command with --strict fails where this does
};
std::string_view to_string(GateState state);  // "passed", "failed", "not checked"

}  // namespace limber
