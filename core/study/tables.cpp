// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/tables.h"

#include <algorithm>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "core/batch/computing_sources.h"
#include "core/tissue/tissue_match.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

Json gates_json(const CellResult& cell) {
  Json rows = Json::array();
  for (const QualityGate& gate : cell.gates) {
    Json row{{"id", gate.id}, {"name", gate.name}};
    if (gate.state != GateState::NotMeasured)
      row.update({{"passed", gate.state == GateState::Passed}, {"figure", gate.figure}});
    if (!gate.worst.empty()) row["worst"] = gate.worst;
    rows.push_back(row);
  }
  return rows;
}

// Returns, as JSON, the gates of all labels that are large enough to be judged.
Json label_gates_json(const CellResult& cell, const QualityLimits& limits) {
  Json rows = Json::array();
  for (const TissueFigures& tissue : cell.tissues)
    if (const std::optional<bool> passed = label_passes(tissue, limits))
      rows.push_back({{"label", tissue.label},
                      {"name", tissue.name},
                      {"voxels", tissue.voxels_before},
                      {"volume_change_percent", *tissue.volume_percent},
                      {"passed", *passed}});
  return rows;
}

Json cell_json(const Study& study, const CellResult& cell) {
  const auto& spacing = study.spacings[cell.cell.spacing];
  Json row{{"spacing_mm", spacing ? Json(*spacing) : Json()},
           {"pose", study.poses[cell.cell.pose].name},
           {"method", word_of(study.techniques[cell.cell.technique])}};
  if (!cell.done()) {
    row["failure"] = cell.failure;
    return row;
  }
  const Json own = Json::parse(cell.cell_json);
  row["folder"] = "cells/" + cell.folder.filename().string();
  for (const char* key : {"key", "pose_reached", "cpu_seconds", "wall_seconds", "machine"}) row[key] = own.at(key);
  if (own.contains("repeats")) row["repeats"] = own["repeats"];
  row["gates"] = gates_json(cell);
  row["label_gates"] = label_gates_json(cell, study.gates);
  row["report"] = Json::parse(cell.report);
  return row;
}

using Row = std::map<std::string, std::string>;

// Adds the figures in a JSON value to a row of the table. A column's name is the path to the figure, joined by dots. In
// a list of objects, the object's "name", "bone", "path" or "label" is part of the path. A list of plain values becomes
// one field, joined by "; ".
void flatten(const Json& value, const std::string& name, std::vector<std::string>& order, Row& row) {
  const auto put = [&](const std::string& text) {
    if (row.emplace(name, text).second) order.push_back(name);
  };
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) flatten(inner, name.empty() ? key : name + "." + key, order, row);
  } else if (value.is_array()) {
    const bool is_named = !value.empty() && value.front().is_object();
    std::string joined;
    std::set<std::string> seen;
    for (const Json& inner : value) {
      if (is_named) {
        std::string key = inner.contains("label") ? inner["label"].dump() : "";
        for (const char* by : {"name", "bone", "path"})
          if (inner.contains(by) && inner[by].is_string()) {
            key = inner[by].get<std::string>();
            break;
          }
        if (!seen.insert(key).second && inner.contains("label")) key += " (" + inner["label"].dump() + ")";
        for (const auto& [inner_key, figure] : inner.items())
          if (inner_key != "name" && inner_key != "bone" && inner_key != "path")
            flatten(figure, name + "." + key + "." + inner_key, order, row);
      } else {
        joined += (joined.empty() ? "" : "; ") + (inner.is_string() ? inner.get<std::string>() : inner.dump());
      }
    }
    if (!is_named) put(joined);
  } else {
    put(value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump());
  }
}

}  // namespace

std::string cells_json(const Study& study, const std::vector<CellResult>& cells, const std::string& commit) {
  Json json{{"schema", "limber-study/1"},
            {"version", LIMBER_VERSION},
            {"commit", commit},
            {"sources", computing_sources()},
            {"study", Json::parse(to_json(study))},
            {"cells", Json::array()}};
  for (const CellResult& cell : cells) json["cells"].push_back(cell_json(study, cell));
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string cells_csv(const Study& study, const std::vector<CellResult>& cells) {
  std::vector<std::string> columns;
  std::vector<Row> rows;
  for (const CellResult& cell : cells) {
    Json json = cell_json(study, cell);
    json.erase("gates");
    json.erase("label_gates");
    if (json.contains("report")) {
      Json report = std::move(json["report"]);
      json.erase("report");
      for (const char* key : {"schema", "method", "inputs", "settings"}) report.erase(key);
      json.update(report);
    }
    std::vector<std::string> order;
    Row row;
    flatten(json, "", order, row);
    // Adds the columns that earlier rows lack. Each is inserted after the column that precedes it in this row.
    std::size_t at = 0;
    for (const std::string& name : order) {
      const auto found = std::find(columns.begin(), columns.end(), name);
      if (found == columns.end()) columns.insert(columns.begin() + static_cast<std::ptrdiff_t>(at++), name);
      else at = static_cast<std::size_t>(found - columns.begin()) + 1;
    }
    rows.push_back(std::move(row));
  }
  std::string text;
  for (std::size_t c = 0; c < columns.size(); ++c) text += (c ? "," : "") + csv_field(columns[c]);
  text += "\r\n";
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto found = row.find(columns[c]);
      text += (c ? "," : "") + (found == row.end() ? "" : csv_field(found->second));
    }
    text += "\r\n";
  }
  return text;
}

}  // namespace limber
