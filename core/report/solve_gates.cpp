// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/solve_gates.h"

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
namespace limber {

namespace {

using Json = nlohmann::json;

// Returns the report's object with this key; an empty object if there is none.
Json part(const Json& report, const char* key) {
  return report.is_object() && report.contains(key) && report[key].is_object() ? report[key] : Json::object();
}

std::string formatted(const char* format, double value) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

QualityGate unmeasured(const char* id, const char* name, const char* meaning, const char* limit) {
  QualityGate gate;
  gate.id = id, gate.name = name, gate.meaning = meaning, gate.limit = limit;
  gate.sentence = "\"" + gate.name + "\" is not checked: no solve by finite elements has figures for it.";
  gate.strict = true;
  return gate;
}

QualityGate judge_reached(const Json& report) {
  QualityGate gate =
      unmeasured("reached", "Pose reached",
                 "How much of the pose the finite element solve reached, and whether it converged there.", "all of it");
  const Json solve = part(report, "solve");
  if (!solve.contains("reached") || !solve["reached"].is_number() || !solve.contains("converged") ||
      !solve["converged"].is_boolean())
    return gate;
  const double reached = solve["reached"];
  const bool converged = solve["converged"];
  gate.state = converged ? GateState::Passed : GateState::Failed;
  gate.figure = formatted("%.0f %%", std::floor(100 * reached)) + (converged || reached < 1 ? "" : ", not converged");
  gate.sentence = "Share of the pose that the solve reached: " + gate.figure + ".";
  return gate;
}

QualityGate judge_gap(const Json& report) {
  QualityGate gate = unmeasured(
      "gap", "Gap",
      "Smallest distance between skin surfaces that came near each other in the solve. Not measured if none did.",
      "more than 0 mm");
  const Json mesh = part(report, "mesh");
  if (!mesh.contains("min_gap_mm") || !mesh["min_gap_mm"].is_number()) return gate;
  const double gap_mm = mesh["min_gap_mm"];
  gate.state = gap_mm > 0 ? GateState::Passed : GateState::Failed;
  gate.figure = formatted("%.3f mm", gap_mm);
  gate.sentence = "The smallest distance between skin surfaces near each other is " + gate.figure + ".";
  return gate;
}

}  // namespace

std::vector<QualityGate> solve_gates(const std::string& report) {
  const Json json = Json::parse(sound_json(report), nullptr, false);
  return {judge_reached(json), judge_gap(json)};
}

}  // namespace limber
