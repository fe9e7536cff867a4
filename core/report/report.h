// SPDX-License-Identifier: AGPL-3.0-or-later
// The report on a posed volume (JSON of schema limber-report/1): the settings, the input files, the time of each stage,
// and what the pose changed. A figure that was not measured is left out, never written as zero.
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
// Describes an input file by its path and hash. A folder's hash covers all its files. Throws Error when the file or
// folder cannot be read.
InputFile describe_input(const Path& path);

// Wall-clock seconds of each stage; empty for a stage that did not run.
struct StageSeconds {
  std::optional<double> read, weights, glide, deform, mesh, solve, rasterize, report, write, total;
};

// A joint that a pose turns, named by its bone.
struct TurnedJoint {
  std::string bone;
  double degrees = 0;                           // angle of the bone's rotation from rest, relative to its parent
  glm::dvec3 axis{0};                           // unit vector of the rotation axis in the pose, world
  glm::dvec3 head{0}, tail{0}, parent_head{0};  // posed positions of the bone and of its parent's head, world, mm
  std::optional<double> excess_degrees;         // degrees beyond the bone's limits, 0: within; empty: no limits
};
// Returns the turned joints in the order of the rig's bones.
std::vector<TurnedJoint> turned_joints(const Armature& rig, const Pose& pose);

struct Report {
  std::string method;  // method of posing: "lbs", "dqs", "fem"; empty when two volumes were only compared
  std::map<std::string, SettingValue> settings;
  std::vector<InputFile> inputs;
  std::vector<TurnedJoint> joints;
  // The joints that were translated so that their bones do not overlap. Empty: joints do not glide.
  std::optional<std::vector<GlidedJoint>> glide;
  StageSeconds seconds;
  std::optional<VolumeMetrics> metrics;
  // Reasons why the input files may not belong together (input_doubts.h). Empty optional: not checked.
  std::optional<std::vector<std::string>> doubts;
  std::optional<bool> whole_body;  // true: the rig has legs, and arms or a head; none: no rig
  PosedBoneMeasures posed_bones;
  std::optional<Exposure> exposure;
  std::optional<WorstPlace> air_pocket;  // the largest pocket of air that the pose encloses; none: no such air
  std::optional<std::vector<Band>> bands;
  std::vector<double> dice;  // Dice's coefficient of each label (dice.h); empty: not measured
  std::optional<DeformReport> deform;
  std::vector<std::string> warnings;
  std::vector<QualityGate> gates;
};

// Measures the posed body and stores the results in `report`. Exposed tissue is measured if the displacement is known;
// bones, limbs and bands if there is a rig too; the largest air pocket if `report.metrics` says that air was enclosed.
// Also stores whether the rig is that of a whole body.
void measure_body(const JudgedPose& pose, const BoneMap& map, Report& report);
// Judges the figures of the report and stores the gates in report.gates (quality_gates.h).
void judge(Report& report);
// Returns the sentence of each gate that failed and for which a command with --strict fails.
std::vector<std::string> failed_gates(const Report& report);

std::string to_json(const Report& report);
// Returns the stages that have a time, with their names in reports, in order.
std::vector<std::pair<std::string, double>> stages_of(const StageSeconds& seconds);
void write_report(const Report& report, const Path& path);
// Returns the seconds that the posing method took, from the JSON text of a report; 0: the report has no times. The time
// for computing weights, reading files and writing the report is not included.
double method_seconds(const std::string& report);
// Prints the report as a table that fits a terminal of 100 columns.
void print_report(std::ostream& out, const Report& report);

// Returns the largest resident memory that this process has had so far, in MB (10^6 bytes).
double peak_memory_mb();

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace limber
