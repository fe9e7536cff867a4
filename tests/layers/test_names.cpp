// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks that private names which were replaced by terms of the field are not used again for functions, types, members
// or files. As words in comments and strings they are allowed.
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/layers/sources.h"

using namespace limber::layers;

namespace {

struct Replaced {
  std::string name, by;
  std::string below = "";  // the folder in which the name is not allowed; empty: everywhere
};

const std::vector<Replaced> kReplaced = {
    {"Handling", "TransformSettings"},
    {"handling", "transform_settings"},
    {"SeenFrom", "ViewProjection"},
    {"Remembered", "RecentFiles"},
    {"remembered", "recent_files"},
    {"why_not", "disabled_reason"},
    {"sentence", "description", "editor/context/"},
    {"Places", "NodePositions", "core/"},
    {"Curvature", "HessianKind"},
    {"can_spare", "is_simple_point"},
    {"hang_together", "is_connected_26"},
    {"SoftBody", "HeatGraph"},
    {"bone_holding", "fixed_bone"},
    {"heir", "fallback_bone"},
    {"share_out", "distribute"},
    {"principal", "signed_svd", "core/fem/"},
    {"MovingTissue", "DeformingRegion"},
    {"yielding", "limit_step", "core/fem/"},
    {"guard", "add_inversion_guard", "core/fem/"},
    {"draw_inside", "pull_inside"},
    {"fit_starts", "initial_guess"},
    {"joint_reading", "joint_angle"},
    {"misfit", "residual"},
    {"DeckFormat", "Exporter"},
    {"kWithIt", "what it limits"},
    {"kLonger", "what it limits"},
};

const std::vector<std::string> kFiles = {"sitting",     "facts",      "handling",      "adjust", "remembered",
                                         "seen_from",   "places",     "soft_body",     "mend",   "principal",
                                         "draw_inside", "fit_starts", "joint_reading", "decks",  "moving_tissue"};

// Returns the code of a line without quoted text and comments.
std::string code_of(const std::string& line) {
  static const std::regex quoted(R"("([^"\\]|\\.)*"|'([^'\\]|\\.)+')");
  const std::string plain = std::regex_replace(line, quoted, "");
  return plain.substr(0, plain.find("//"));
}

}  // namespace

TEST_CASE("names: what was replaced by the field's own words is no name again") {
  std::map<std::string, const Replaced*> replaced;
  for (const Replaced& one : kReplaced) replaced[one.name] = &one;
  static const std::regex word(R"([A-Za-z_][A-Za-z0-9_]*)");
  for (const fs::path& file : sources({"core", "render", "editor"})) {
    const std::string name = file.generic_string();
    for (const std::string& line : lines_of(file)) {
      const std::string code = line.starts_with("#include") ? "" : code_of(line);
      for (std::sregex_iterator it(code.begin(), code.end(), word), end; it != end; ++it) {
        const auto found = replaced.find(it->str());
        if (found == replaced.end() || !name.starts_with(found->second->below)) continue;
        INFO(name, ": ", line);
        INFO("say ", found->second->by);
        CHECK(found == replaced.end());
      }
    }
  }
}

TEST_CASE("names: no file has a name that was replaced") {
  for (const fs::path& file : sources({"core", "render", "editor"}))
    for (const std::string& name : kFiles) {
      INFO(file.generic_string());
      CHECK(file.stem() != name);
    }
}

// Two types of one full name violate the one-definition rule, even in files that do not include each other: of two
// inline functions of these types, such as their destructors, the linker keeps only one.
TEST_CASE("names: no two types of one namespace have the same name") {
  static const std::regex opens(R"(^namespace\s*([\w:]*)\s*\{)"), closes(R"(^\}.*// namespace)"),
      type(R"(^(?:struct|class|union|enum class|enum)\s+(\w+)(?:\s+final)?\s*(?::[^:].*)?\{)");
  std::map<std::string, std::string> file_of;
  for (const fs::path& file : sources({"core", "render", "editor"})) {
    std::vector<std::string> inside;
    for (const std::string& line : lines_of(file)) {
      std::smatch found;
      if (std::regex_search(line, found, opens)) inside.push_back(found[1]);
      else if (std::regex_search(line, closes) && !inside.empty()) inside.pop_back();
      if (!std::regex_search(line, found, type)) continue;
      std::string name;
      bool is_local = false;  // true: the type is in an unnamed namespace
      for (const std::string& one : inside) is_local |= one.empty(), name += one + "::";
      if (is_local) continue;
      name += found[1];
      INFO(name, " in ", file.generic_string(), " and ", file_of[name]);
      CHECK(file_of[name].empty());
      file_of[name] = file.generic_string();
    }
  }
  CHECK(file_of.size() > 500);
}
