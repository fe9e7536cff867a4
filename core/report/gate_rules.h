// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines how quality gates are written and judged. Each gate is a rule in a table: its limit, its meaning, and a
// function that judges the figures of a report in JSON. The JSON type is a template parameter, so that no header
// depends on the JSON library.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "core/report/quality_gate.h"

namespace limber {

template <class Json>
std::optional<double> number(const Json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found != json.end() && found->is_number() ? std::optional(found->template get<double>()) : std::nullopt;
}

template <class Json>
std::string text(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->template get<std::string>() : "";
}

template <class Json>
const Json& part(const Json& json, const char* key) {
  static const Json kNothing;
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found == json.end() ? kNothing : *found;
}

inline std::string formatted(const char* format, double value) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// Returns text with a number and a noun, which gets an "s" unless the number is 1: "3 286 voxels", "1 pair".
inline std::string counted(double count, const char* what) {
  std::string digits = formatted("%.0f", count);
  for (auto place = static_cast<std::ptrdiff_t>(digits.size()) - 3; place > 0; place -= 3)
    digits.insert(static_cast<std::size_t>(place), " ");
  return digits + " " + what + (count == 1 ? "" : "s");
}

inline std::string in_quotes(const std::string& name) { return "\"" + name.substr(0, 80) + "\""; }

// Returns text for the position at which a fault is worst, such as " at (12, -40, 812) mm near LeftThigh".
template <class Json>
std::string at_place(const Json& worst) {
  const Json& place = part(worst, "place");
  if (!place.is_array() || place.size() != 3) return "";
  std::string words = " at (";
  for (const Json& one : place)
    words += (one == place[0] && words.back() == '(' ? "" : ", ") +
             (one.is_number() ? formatted("%.0f", one.template get<double>()) : "?");
  const std::string near = text(worst, "near");
  return words + ") mm" + (near.empty() ? "" : " near " + near);
}

inline void decide(QualityGate& gate, bool passed, std::string figure, std::string sentence = "") {
  gate.state = passed ? GateState::Passed : GateState::Failed;
  gate.figure = std::move(figure);
  gate.sentence = std::move(sentence);
}

inline void not_checked(QualityGate& gate, const std::string& why) {
  gate.sentence = in_quotes(gate.name) + " is not checked: " + why;
}

using LimitText = std::string (*)(const QualityLimits& limits);

// A rule that judges one gate. "{}" in the name and in the meaning is replaced by the limit.
template <class Json>
struct GateRule {
  const char* id;
  const char* name;
  const char* meaning;
  LimitText limit;
  bool strict;
  void (*judge)(const Json& report, const QualityLimits& limits, QualityGate& gate);
};

inline std::string none(const QualityLimits&) { return "none"; }

template <double QualityLimits::*kLimit>
std::string at_most_percent(const QualityLimits& limits) {
  return "at most " + formatted("%g %%", limits.*kLimit);
}

inline std::string with_limit(std::string words, const std::string& limit) {
  if (const auto place = words.find("{}"); place != std::string::npos) words.replace(place, 2, limit);
  return words;
}

// Judges a report by each rule, and returns the gates in the order of the rules.
//   report  JSON text of schema limber-report/1; if it is not JSON, no gate is measured
template <class Json, std::size_t N>
std::vector<QualityGate> judged(const GateRule<Json> (&rules)[N], const std::string& report,
                                const QualityLimits& limits) {
  const Json json = Json::parse(report, nullptr, false);
  std::vector<QualityGate> gates;
  for (const GateRule<Json>& rule : rules) {
    QualityGate& gate = gates.emplace_back();
    gate.id = rule.id;
    gate.limit = rule.limit(limits);
    gate.name = with_limit(rule.name, gate.limit);
    gate.meaning = with_limit(rule.meaning, gate.limit);
    gate.strict = rule.strict;
    rule.judge(json, limits, gate);
    if (gate.sentence.empty() && gate.state == GateState::NotMeasured)
      not_checked(gate, "the report has no figures for it.");
    if (gate.sentence.empty())
      gate.sentence = gate.name + ": " + gate.figure + (gate.worst.empty() ? "" : ", " + gate.worst) + ".";
  }
  return gates;
}

// Returns the row of a JSON array with the largest figure(row); nullptr: no row has a figure.
template <class Json, class Figure>
const Json* worst_row(const Json& rows, const Figure& figure) {
  const Json* worst = nullptr;
  double most = 0;
  if (rows.is_array())
    for (const Json& row : rows)
      if (const std::optional<double> value = figure(row); value && (!worst || *value > most))
        most = *value, worst = &row;
  return worst;
}

}  // namespace limber
