// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/observations.h"

#include <set>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/tissue/tissue_match.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

// Keys of a report that are left out: they contain no figures of the result, or differ from run to run.
const std::set<std::string> kLeftOut = {"schema", "version", "method",         "settings",
                                        "inputs", "seconds", "peak_memory_mb", "warnings"};

class Rows {
 public:
  explicit Rows(const std::vector<std::string>& columns, const std::vector<std::string>& more) {
    for (const std::string& column : columns) text_ += csv_field(column) + ",";
    for (const std::string& column : more) text_ += (&column == &more.front() ? "" : ",") + column;
    text_ += "\r\n";
  }
  void add(const std::vector<std::string>& fields, const std::vector<std::string>& more) {
    for (const std::string& field : fields) text_ += csv_field(field) + ",";
    for (const std::string& field : more) text_ += (&field == &more.front() ? "" : ",") + csv_field(field);
    text_ += "\r\n";
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

// Returns the text of a single value; null gives an empty text, which is a missing value.
std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  return value.is_null() ? "" : value.dump();
}

// Returns the name of the thing that an object in a list describes: its name, bone, id or label.
std::string item_of(const Json& object) {
  for (const char* key : {"name", "bone", "id"})
    if (object.contains(key) && object[key].is_string()) return object[key].get<std::string>();
  return object.contains("label") ? object["label"].dump() : "";
}

// Adds a row for a single value, or for each value in an object or list. The quantity of a nested value is the path of
// its keys and list indices, joined by dots; each object in a list is an item of its own.
void add_value(Rows& rows, const std::vector<std::string>& fields, const std::string& group, const std::string& item,
               const std::string& quantity, const Json& value) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      add_value(rows, fields, group, item, quantity.empty() ? key : quantity + "." + key, inner);
  } else if (value.is_array() && !value.empty() && value.front().is_object()) {
    std::set<std::string> seen;
    for (const Json& inner : value) {
      std::string of = item_of(inner);
      if (!seen.insert(of).second && inner.contains("label")) of += " (" + inner["label"].dump() + ")";
      add_value(rows, fields, group, of, quantity, inner);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      add_value(rows, fields, group, item, quantity + "." + std::to_string(i), value[i]);
  } else if (quantity != "name" && quantity != "bone" && quantity != "id" && quantity != "sentence") {
    rows.add(fields, {group, item, quantity, value_text(value)});
  }
}

Json parse(const std::string& text) { return Json::parse(sound_json(text), nullptr, false); }
}  // namespace

std::string observations_csv(const std::vector<std::string>& columns, const std::vector<Observed>& cells) {
  Rows rows(columns, {"group", "item", "quantity", "value"});
  for (const Observed& cell : cells) {
    if (!cell.failure.empty()) rows.add(cell.fields, {"cell", "", "failure", cell.failure});
    if (cell.report.empty()) continue;
    const Json report = parse(cell.report);
    if (!report.is_object()) continue;
    for (const auto& [group, value] : report.items())
      if (!kLeftOut.contains(group)) add_value(rows, cell.fields, group, "", value.is_primitive() ? group : "", value);
  }
  return std::move(rows).text();
}

std::string times_csv(const std::vector<std::string>& columns, const std::vector<Observed>& cells) {
  Rows rows(columns, {"machine", "quantity", "value"});
  for (const Observed& cell : cells) {
    if (cell.report.empty()) continue;
    const Json report = parse(cell.report), own = parse(cell.cell);
    if (!report.is_object() || !own.is_object()) continue;
    const std::string machine = own.value("machine", "");
    const auto add = [&](const std::string& quantity, const Json& value) {
      rows.add(cell.fields, {machine, quantity, value_text(value)});
    };
    if (report.contains("seconds"))
      for (const auto& [stage, seconds] : report["seconds"].items()) add(stage + "_s", seconds);
    if (own.contains("cpu_seconds")) add("cpu_s", own["cpu_seconds"]);
    if (report.contains("peak_memory_mb")) add("peak_memory_mb", report["peak_memory_mb"]);
  }
  return std::move(rows).text();
}

}  // namespace limber
