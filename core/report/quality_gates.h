// SPDX-License-Identifier: AGPL-3.0-or-later
// What a posed volume must pass before it is believed, judged from its report. A gate that the report has no figures for (a mesh,
// where nothing was meshed) is neither passed nor failed: it is not checked, and says so.
//
// Gates of the body say whether the result is a body at all, by measures that know nothing of the program's own bone parts and
// weights; a command with --strict fails where one of them does:
//   inputs      rig and labels belong together
//   whole       each bone that a label names is one rigid thing
//   follows     ... and goes with the rig bone that it belongs to
//   directions  limbs point where the pose asked
//   exposed     no tissue of the inside comes to the air
//   trapped     no air is closed in
//   organs      volumes of organs; lost: no label vanishes; torn: no label falls apart
//   bands       no tissue is pulled out between parts that are no neighbours
//   volume      of the whole body
// Fine gates compare methods:
//   tissues    the volume of each; where no tissue is large enough, all are judged
//   bones      how far the program's bone parts are from a rigid motion
//   skin       its share of the surface, against that at rest, where cut limbs show flesh
//   islands    no tissue in more pieces than at rest, no voxel without a label inside the image of tissue
//   inverted   no cell of the mesh turned inside out
//   crossings  no triangles of the skin cross, no voxel is claimed twice
//   limits     no joint further than its limits allow
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct Pose;
struct Report;

struct QualityLimits {
  double tissue_percent = 1;
  std::int64_t least_voxels = 5000;   // of a tissue at rest: fewer change by up to 2 % when a rigid part alone is sampled anew
  double bone_residual_mm = 0.05;     // a fortieth of a voxel of 2 mm
  double skin_share_percent = 0.2;    // of the surface, that is no longer skin
  double joint_excess_degrees = 0.1;
  // Of the body.
  double wrong_bone_percent = 0.1;    // of a bone's voxels
  double direction_degrees = 1;
  double exposed_percent = 0.1;       // of the posed surface
  double trapped_voxels = 50;
  double organ_percent = 10;
  double lost_percent = 50;           // of a label's volume
  std::int64_t least_organ_voxels = 200;
  double body_percent = 2;
  double limb_percent = 5;            // of a limb alone, of which one bent joint is a good part
};

enum class GateState { Passed, Failed, NotMeasured };

struct QualityGate {
  std::string id;      // as above
  std::string name;    // "Each tissue within 1 %"
  GateState state = GateState::NotMeasured;
  std::string figure;  // "-0.30 %", "3 286 voxels"; empty where nothing was measured
  std::string worst;   // the tissue or bone whose figure that is; empty for none
  std::string meaning;  // a sentence: what is measured
  std::string sentence;  // what came out, and why where nothing did
  std::string limit;     // "at most 0.1 %"
  bool strict = false;   // whether a command with --strict fails where this does
};
std::string_view to_string(GateState state);  // "passed", "failed", "not checked"

// In the order above.
//   report  limber-report/1, JSON; from text that is none nothing is measured
std::vector<QualityGate> body_gates(const std::string& report, const QualityLimits& limits = {});
std::vector<QualityGate> quality_gates(const std::string& report, const QualityLimits& limits = {});  // the fine ones
std::vector<QualityGate> quality_gates(const Report& report, const QualityLimits& limits = {});
// Those of the body, the fine ones and those of a solve (solve_gates.h).
std::vector<QualityGate> all_gates(const std::string& report, const QualityLimits& limits = {});

// `limits` of them, of a rig and a pose at hand.
QualityGate judge_joint_limits(const Armature& armature, const Pose& pose, const QualityLimits& limits = {});

}  // namespace limber
