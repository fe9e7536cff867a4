// SPDX-License-Identifier: AGPL-3.0-or-later
// The gates that a posed volume must pass before its user may trust it, judged from its report. A gate for which the
// report has no figures (such as figures of a mesh where nothing was meshed) neither passes nor fails: it is reported
// as not checked.
//
// Body gates tell whether the result is still a body. Their measures depend neither on weights nor on the bones into
// which this program splits bone tissue. A command with --strict fails if one of the body gates fails:
//   inputs      rig and labels belong together
//   whole       each bone that a label names stays rigid
//   follows     each of these bones follows the rig bone that it belongs to
//   directions  limbs have the directions that the pose requests
//   exposed     no inner tissue touches the air
//   trapped     no air is enclosed that was not enclosed at rest
//   organs      organs keep their volume
//   lost        no label vanishes
//   torn        no label falls apart
//   bands       no tissue is pulled out between parts of the body that are no neighbours
//   volume      the whole body keeps its volume
// Fine gates compare methods:
//   tissues    each large tissue keeps its volume; if no tissue is large, all tissues are judged
//   bones      the bones into which the program splits bone tissue move rigidly
//   skin       skin covers as large a share of the surface as at rest (the cut end of a limb has no skin at rest
//              either)
//   islands    no tissue has more components than at rest, and no voxel inside posed tissue lacks a label
//   inverted   no tet of the mesh is inverted
//   crossings  no triangles of the skin cross, and no two regions of the body overlap in a voxel
//   limits     no joint is turned beyond its limits
#pragma once

#include <string>
#include <vector>

#include "core/report/quality_gate.h"
#include "core/rig/armature.h"

namespace limber {

struct Pose;
struct Report;

// Return the body gates or the fine gates, in the order of the lists at the head of this file.
//   report  JSON text of schema limber-report/1; if it is not JSON, no gate is measured
std::vector<QualityGate> body_gates(const std::string& report, const QualityLimits& limits = {});
// Returns the fine gates.
std::vector<QualityGate> quality_gates(const std::string& report, const QualityLimits& limits = {});
std::vector<QualityGate> quality_gates(const Report& report, const QualityLimits& limits = {});
// Returns the body gates, the fine gates and the gates of a solve (solve_gates.h).
std::vector<QualityGate> all_gates(const std::string& report, const QualityLimits& limits = {});

// Judges the fine gate `limits` (joint limits) directly from a rig and a pose.
QualityGate judge_joint_limits(const Armature& armature, const Pose& pose, const QualityLimits& limits = {});

}  // namespace limber
