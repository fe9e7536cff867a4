// SPDX-License-Identifier: AGPL-3.0-or-later
// The gates that a posed volume must pass before its user may trust it, judged from its report. A gate for which the
// report has no figures (such as figures of a mesh where nothing was meshed) neither passes nor fails: it is reported
// as not checked.
//
// Body gates tell whether the result is still a body, by measures that do not depend on the program's own split of bone
// tissue into bones and on its weights. A command with --strict fails where one of them fails:
//   inputs      rig and labels belong together
//   whole       each bone that a label names stays rigid
//   follows     each of these bones follows the rig bone that it belongs to
//   directions  limbs point where the pose asks
//   exposed     no inner tissue touches the air
//   trapped     no air is enclosed that was not enclosed at rest
//   organs      organs keep their volume
//   lost        no label vanishes
//   torn        no label falls apart
//   bands       no tissue is pulled out between parts of the body that are no neighbours
//   volume      the whole body keeps its volume
// Fine gates compare methods:
//   tissues    each large tissue keeps its volume; where no tissue is large enough, all are judged
//   bones      the bones into which the program splits bone tissue move rigidly
//   skin       skin covers as much of the surface as at rest, where cut limbs may show flesh
//   islands    no tissue has more components than at rest, and no voxel inside posed tissue lacks a label
//   inverted   no tet of the mesh is inverted
//   crossings  no triangles of the skin cross, and no voxel is claimed twice
//   limits     no joint is turned beyond its limits
#pragma once

#include <string>
#include <vector>

#include "core/report/quality_gate.h"
#include "core/rig/armature.h"

namespace limber {

struct Pose;
struct Report;

// Return the gates in the order of the list at the head of this file.
//   report  limber-report/1, JSON; when it is not JSON, every gate is not measured
std::vector<QualityGate> body_gates(const std::string& report, const QualityLimits& limits = {});
std::vector<QualityGate> quality_gates(const std::string& report, const QualityLimits& limits = {});  // fine gates only
std::vector<QualityGate> quality_gates(const Report& report, const QualityLimits& limits = {});
// Returns the body gates, the fine gates and the gates of a solve (solve_gates.h).
std::vector<QualityGate> all_gates(const std::string& report, const QualityLimits& limits = {});

// Judges the fine gate `limits` for a rig and a pose, without a report.
QualityGate judge_joint_limits(const Armature& armature, const Pose& pose, const QualityLimits& limits = {});

}  // namespace limber
