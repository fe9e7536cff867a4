// SPDX-License-Identifier: AGPL-3.0-or-later
// Prints the description of a file. Each kind of file is described once, as JSON; the text is made from that JSON.
#include <algorithm>
#include <sstream>

#include <nlohmann/json.hpp>

#include "core/cmd/command.h"
#include "core/report/report.h"

namespace limber::cmd {

namespace {
using Json = nlohmann::ordered_json;

std::string in_words(const Json& value) {
  if (value.is_string()) return one_line(value.get<std::string>());
  if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const Json& part : value)
    text += (text.empty() ? "" : "  ") + part.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text;
}

void show_list(const std::string& name, const Json& list) {
  constexpr std::size_t kShown = 200;
  print("%-11s %zu\n", name.c_str(), list.size());
  for (std::size_t i = 0; i < std::min(list.size(), kShown); ++i) {
    std::string line = "           ";
    for (const auto& [key, value] : list[i].items())
      line +=
          " " + (value.is_number() || value.is_string() ? in_words(value) + " " : key + " " + in_words(value) + " ");
    print("%s\n", line.c_str());
  }
  if (list.size() > kShown) print("            and %zu more (--json lists all)\n", list.size() - kShown);
}

void show(const Json& json) {
  for (const auto& [key, value] : json.items())
    if (value.is_array() && !value.empty() && value[0].is_object()) show_list(key, value);
    else print("%-11s %s\n", key.c_str(), in_words(value).c_str());
}
}  // namespace

void print_table(const Report& report) {
  std::ostringstream table;
  print_report(table, report);
  print_text(table.str());
}

void print_description(const std::string& json, bool as_json) {
  const Json description = Json::parse(json);
  if (as_json) print_json(description.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  else show(description);
}

}  // namespace limber::cmd
