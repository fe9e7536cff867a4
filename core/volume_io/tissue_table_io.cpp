// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes label tables in three formats. Limber's JSON is {"17": {"name", "kind" or "class", ...}} or {"17":
// "name"}. 3D Slicer's and FreeSurfer's colour tables have lines `value name r g b a` with colours from 0 to 255.
// ITK-SNAP's label descriptions have lines `value r g b a visible meshed "name"`. An entry for value 0 is ignored,
// because 0 is air.
#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/base/text_parse.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/tissue_table_io.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

namespace {
using Json = nlohmann::json;

constexpr std::uint64_t kMostBytes = 64 << 20;

Tissue tissue_for(double file_value, std::string name) {
  Tissue tissue;
  tissue.file_value = file_value;
  if (file_value >= 1 && file_value <= 65535) tissue.label = static_cast<Label>(file_value);
  tissue.name = std::move(name);
  tissue.kind = tissue_kind_from_name(tissue.name);
  apply_kind_defaults(tissue);
  return tissue;
}

double file_value_of(std::string_view text, const std::string& where) {
  const auto value = number_of<double>(text);
  if (!value || *value != std::floor(*value) || std::abs(*value) > 9007199254740992.0)
    throw Error("the label " + in_quotes(text) + " is not a whole number", where,
                "labels are the numbers in the volume");
  return *value;
}

// ---- JSON

double number_field(const Json& entry, const char* name, double otherwise, double lowest, double highest,
                    const std::string& where) {
  if (!entry.contains(name) || entry[name].is_null()) return otherwise;
  if (!entry[name].is_number())
    throw Error(std::string("\"") + name + "\" is not a number", where, "correct the table");
  const double value = entry[name].get<double>();
  if (!(value >= lowest && value <= highest))
    throw Error(std::string("\"") + name + "\" is " + text_of(value), where,
                "it must lie between " + text_of(lowest) + " and " + text_of(highest));
  return value;
}

int hexadecimal(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

// Parses a colour: "#rrggbb", or [r, g, b] in [0, 1]. If any of the three numbers exceeds 1, all three are in [0, 255].
glm::vec3 colour_from(const Json& json, const std::string& where) {
  const auto wrong = [&] {
    return Error("the colour is neither [r, g, b] nor \"#rrggbb\"", where, "correct the table");
  };
  glm::vec3 colour(0);
  if (json.is_string()) {
    const auto& text = json.get_ref<const std::string&>();
    if (text.size() != 7 || text[0] != '#') throw wrong();
    for (std::size_t i = 0; i < 3; ++i) {
      const int high = hexadecimal(text[1 + 2 * i]), low = hexadecimal(text[2 + 2 * i]);
      if (high < 0 || low < 0) throw wrong();
      colour[static_cast<int>(i)] = static_cast<float>(high * 16 + low) / 255;
    }
    return colour;
  }
  if (!json.is_array() || json.size() < 3) throw wrong();
  for (int i = 0; i < 3; ++i) {
    if (!json[static_cast<std::size_t>(i)].is_number()) throw wrong();
    colour[i] = json[static_cast<std::size_t>(i)].get<float>();
    if (!(colour[i] >= 0 && colour[i] <= 255)) throw wrong();
  }
  return std::max({colour.r, colour.g, colour.b}) > 1 ? colour / 255.0f : colour;
}

Tissue tissue_from_json(double value, const Json& entry, const std::string& where) {
  if (entry.is_string()) return tissue_for(value, entry.get<std::string>());
  if (!entry.is_object())
    throw Error("the entry is neither a name nor an object", where, "write {\"name\": ..., \"kind\": ...}");
  const auto text = [&](const char* name) -> std::string {
    if (!entry.contains(name) || entry[name].is_null()) return {};
    if (!entry[name].is_string())
      throw Error(std::string("\"") + name + "\" is not a text", where, "correct the table");
    return entry[name].get<std::string>();
  };
  Tissue tissue = tissue_for(value, text("name"));
  const std::string kind = text("kind"), tissue_class = text("class");
  if (!kind.empty() || !tissue_class.empty()) {
    // The field `class` comes from another program, so its value may be unknown here. The field `kind` is Limber's, and
    // an unknown value is an error.
    const auto known = tissue_kind_from_text(kind.empty() ? tissue_class : kind);
    if (!known && !kind.empty())
      throw Error("unknown kind " + in_quotes(kind), where,
                  "use skin, fat, muscle, bone, cartilage, tendon, vessel, nerve, organ ...");
    if (known) tissue.kind = *known;
    apply_kind_defaults(tissue);
  }
  for (const char* name : {"colour", "color"})
    if (entry.contains(name) && !entry[name].is_null()) tissue.colour = colour_from(entry[name], where);
  tissue.density = number_field(entry, "density", tissue.density, 1e-6, 100, where);
  tissue.young_modulus = number_field(entry, "young_modulus", tissue.young_modulus, 1e-9, 1e12, where);
  tissue.poisson_ratio = number_field(entry, "poisson_ratio", tissue.poisson_ratio, -0.999, 0.49999, where);
  tissue.priority = static_cast<int>(number_field(entry, "priority", tissue.priority, -1e6, 1e6, where));
  return tissue;
}

std::vector<Tissue> tissues_from_json(const std::string& bytes, const std::string& where) {
  Json json;
  try {
    json = Json::parse(checked_json(bytes, where));
  } catch (const Json::exception& error) {
    throw Error("the JSON is damaged", where, std::string(error.what()).substr(0, 120));
  }
  if (!json.is_object()) throw Error("the table is not a JSON object", where, "write {\"17\": {\"name\": \"muscle\"}}");
  std::vector<Tissue> tissues;
  for (const auto& [key, entry] : json.items()) {
    const double value = file_value_of(key, where);
    if (value != 0) tissues.push_back(tissue_from_json(value, entry, where + " label " + key.substr(0, 20)));
  }
  return tissues;
}

// ---- text tables

glm::vec3 colour_from_bytes(const std::vector<std::string_view>& words, std::size_t first, const std::string& where) {
  glm::vec3 colour(0);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto part = number_of<double>(words[first + i]);
    if (!part || !(*part >= 0 && *part <= 255))
      throw Error("the colour is " + in_quotes(words[first + i]), where, "write 0 to 255");
    colour[static_cast<int>(i)] = static_cast<float>(*part / 255);
  }
  return colour;
}

std::vector<Tissue> tissues_from_lines(std::string_view text, const std::string& where) {
  std::vector<Tissue> tissues;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = take_line(rest);
    ++number;
    const auto content = trimmed(line);
    if (content.empty() || content[0] == '#') continue;
    const std::string here = where + " line " + std::to_string(number);
    const auto words = words_of(content);
    const std::size_t quote = content.find('"');
    Tissue tissue;
    if (quote != std::string_view::npos) {
      const std::size_t end = content.rfind('"');
      if (end == quote || words.size() < 8)
        throw Error("the line is not a label description", here, "write: value r g b a visible meshed \"name\"");
      tissue = tissue_for(file_value_of(words[0], here), std::string(content.substr(quote + 1, end - quote - 1)));
      tissue.colour = colour_from_bytes(words, 1, here);
    } else {
      if (words.size() != 6 && words.size() != 5)
        throw Error("the line is not a table entry: " + in_quotes(content), here, "write: value name r g b a");
      tissue = tissue_for(file_value_of(words[0], here), std::string(words[1]));
      tissue.colour = colour_from_bytes(words, 2, here);
    }
    if (tissue.file_value != 0) tissues.push_back(std::move(tissue));
  }
  return tissues;
}

// ---- writing

std::string as_json(const TissueTable& table) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const auto rounded = [](float part) { return std::round(static_cast<double>(part) * 1e4) / 1e4; };
  for (const Tissue& t : table.tissues)
    json[text_of(t.file_value)] = {{"name", t.name},
                                   {"kind", to_string(t.kind)},
                                   {"colour", {rounded(t.colour.r), rounded(t.colour.g), rounded(t.colour.b)}},
                                   {"density", t.density},
                                   {"young_modulus", t.young_modulus},
                                   {"poisson_ratio", t.poisson_ratio},
                                   {"priority", t.priority}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string colour_bytes(const Tissue& tissue) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += (i > 0 ? " " : "") + std::to_string(std::lround(std::clamp(tissue.colour[i], 0.0f, 1.0f) * 255));
  return text;
}

std::string as_ctbl(const TissueTable& table) {
  std::string text = "# Color table file\n# " + std::to_string(table.tissues.size()) + " values\n";
  for (const Tissue& tissue : table.tissues) {
    std::string name = tissue.name.empty() ? "label_" + text_of(tissue.file_value) : tissue.name;
    for (char& c : name)
      if (is_blank(c)) c = '_';
    text += text_of(tissue.file_value) + " " + name + " " + colour_bytes(tissue) + " 255\n";
  }
  return text;
}

std::string as_label_descriptions(const TissueTable& table) {
  std::string text = "# value red green blue alpha visible meshed \"name\"\n0 0 0 0 0 0 0 \"Clear Label\"\n";
  for (const Tissue& tissue : table.tissues) {
    std::string name = tissue.name.empty() ? "Label " + text_of(tissue.file_value) : tissue.name;
    for (char& c : name)
      if (c == '"' || c == '\n' || c == '\r') c = '\'';
    text += text_of(tissue.file_value) + " " + colour_bytes(tissue) + " 1 1 1 \"" + name + "\"\n";
  }
  return text;
}
}  // namespace

TissueTable parse_tissue_table(const std::string& bytes, const std::string& where) {
  const auto start = trimmed(std::string_view(bytes).substr(0, 4096));
  if (start.empty()) throw Error("the label table is empty", where, "write one label per line, or JSON");
  auto tissues =
      start[0] == '{' || start[0] == '[' ? tissues_from_json(bytes, where) : tissues_from_lines(bytes, where);
  if (tissues.empty()) throw Error("the label table names no label", where, "write one label per line, or JSON");

  // When the table has several entries for a value, the last one is used.
  std::map<double, Tissue> by_value;
  for (Tissue& tissue : tissues) by_value[tissue.file_value] = std::move(tissue);
  TissueTable table;
  table.source = Path(where).filename().string();
  for (auto& [value, tissue] : by_value) table.tissues.push_back(std::move(tissue));
  std::stable_sort(table.tissues.begin(), table.tissues.end(),
                   [](const Tissue& a, const Tissue& b) { return a.label < b.label; });
  return table;
}

TissueTable read_tissue_table(const Path& path) {
  return parse_tissue_table(read_file(path, kMostBytes), path.string());
}

bool is_tissue_table(const Path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".ctbl" || extension == ".label") return true;
  if (extension == ".txt") return !is_virtual_family(path);
  if (extension != ".json") return false;
  const Json json = Json::parse(checked_json(read_file(path, kMostBytes), path.string()), nullptr, false);
  if (!json.is_object() || json.empty()) return false;
  for (const auto& [key, entry] : json.items())
    if (key.empty() || key.find_first_not_of("-0123456789") != std::string::npos) return false;
  return true;
}

void write_tissue_table(const TissueTable& table, const Path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".json") return write_file_atomically(path, as_json(table));
  if (extension == ".ctbl") return write_file_atomically(path, as_ctbl(table));
  if (extension == ".txt" || extension == ".label") return write_file_atomically(path, as_label_descriptions(table));
  throw Error("label tables cannot be written with this extension", path.string(), "use .json, .ctbl or .txt");
}

}  // namespace limber
