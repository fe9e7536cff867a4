// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/json_text.h"

#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace limber {

namespace {
using Json = nlohmann::json;

// Inspects a JSON text and stops at the first problem. It handles the parser's events one by one, which needs no
// recursion.
class Inspector final : public nlohmann::json_sax<Json> {
 public:
  std::string problem;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second)
      problem = "the key \"" + name.substr(0, 80) + "\" occurs twice in one object";
    return problem.empty();
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  bool open() {
    keys_.emplace_back();
    if (std::ssize(keys_) > kDeepestJson)
      problem = "the JSON is nested more than " + std::to_string(kDeepestJson) + " levels deep";
    return problem.empty();
  }
  bool close() {
    keys_.pop_back();
    return true;
  }
  // Keys seen so far in each enclosing object; an enclosing array has an empty set.
  std::vector<std::set<std::string>> keys_;
};
}  // namespace

std::string json_problem(const std::string& text) {
  Inspector inspector;
  Json::sax_parse(text, &inspector);
  return inspector.problem;
}

const std::string& checked_json(const std::string& text, const std::string& where) {
  if (const std::string problem = json_problem(text); !problem.empty()) throw Error(problem, where, "correct the file");
  return text;
}

const std::string& sound_json(const std::string& text) {
  static const std::string none;
  return json_problem(text).empty() ? text : none;
}

}  // namespace limber
