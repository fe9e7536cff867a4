// SPDX-License-Identifier: AGPL-3.0-or-later
// What a posed volume must pass before it is believed, judged from its report. A gate that the report has no figures
// for (a mesh, where nothing was meshed) is neither passed nor failed: it is not checked, and says so.
//
// Gates of the body say whether the result is a body at all, by measures that know nothing of the program's own bone
// parts and weights; a command with --strict fails where one of them does:
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

#include <string>
#include <vector>

#include "core/report/quality_gate.h"
#include "core/rig/armature.h"

namespace limber {

struct Pose;
struct Report;

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
