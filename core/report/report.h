// SPDX-License-Identifier: AGPL-3.0-or-later
// The report that goes with a posed volume (schema limber-report/1): what was asked, from which files, how long each
// stage took, and what changed. A part that was not measured is left out, never filled with zeros.
#pragma once

#include <chrono>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/file.h"
#include "core/report/bands.h"
#include "core/report/exposure.h"
#include "core/report/metrics.h"
#include "core/report/posed_bones.h"
#include "core/report/quality_gate.h"
#include "core/resample/glide_joints.h"
#include "core/resample/resample.h"
#include "core/rig/pose.h"

namespace limber {

using SettingValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

struct InputFile {
  std::string path;
  std::string sha256;
};
// Throws Error when the file cannot be read. A folder's hash covers all its files.
InputFile describe_input(const Path& path);

// Wall-clock seconds; a stage that did not run has none.
struct StageSeconds {
  std::optional<double> read, weights, glide, deform, mesh, solve, rasterize, report, write, total;
};

// A joint that a pose turns.
struct TurnedJoint {
  std::string bone;
  double degrees = 0;                           // relative to rest and to the parent
  glm::dvec3 axis{0};                           // unit, world, as the parent stands
  glm::dvec3 head{0}, tail{0}, parent_head{0};  // of the posed bones, world, mm
  std::optional<double> excess_degrees;         // beyond the bone's limits; none where it has none
};
// By bone.
std::vector<TurnedJoint> turned_joints(const Armature& rig, const Pose& pose);

struct Report {
  std::string method;  // "lbs", "dqs", "fem"; empty when two volumes were only compared
  std::map<std::string, SettingValue> settings;
  std::vector<InputFile> inputs;
  std::vector<TurnedJoint> joints;
  std::optional<std::vector<GlidedJoint>> glide;  // those whose bones would overlap; none where joints do not glide
  StageSeconds seconds;
  std::optional<VolumeMetrics> metrics;
  std::optional<std::vector<std::string>>
      doubts;                      // of inputs that do not belong together [input_doubts.h]; none where nobody asked
  std::optional<bool> whole_body;  // whether the rig has legs, and arms or a head; none without a rig
  PosedBones posed_bones;
  std::optional<Exposure> exposure;
  std::optional<WorstPlace> air_pocket;  // the largest, where the pose closed air in
  std::optional<std::vector<Band>> bands;
  std::vector<double> dice;  // by label [dice.h], or empty
  std::optional<DeformReport> deform;
  std::vector<std::string> warnings;
  std::vector<QualityGate> gates;
};

// Everything that is measured of the pose itself: exposure, bones, limbs and bands where it knows the displacement (and
// the rig), and the largest pocket of air where `report.metrics` say that air was closed in. Says of the rig whether it
// is that of a whole body.
void measure_body(const JudgedPose& pose, const BoneMap& map, Report& report);
// Judges the report by itself, into report.gates [quality_gates.h].
void judge(Report& report);
// The sentences of strict gates that failed.
std::vector<std::string> failed_gates(const Report& report);

std::string to_json(const Report& report);
void write_report(const Report& report, const Path& path);
// What the method itself took, by such text: not weights that had to be computed first, files, nor the report. 0 where
// it says nothing.
double method_seconds(const std::string& report);
// The same as a table that reads well in a terminal of 100 columns.
void print_report(std::ostream& out, const Report& report);

// Largest resident memory of this process so far, MB (10^6 bytes).
double peak_memory_mb();

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace limber
