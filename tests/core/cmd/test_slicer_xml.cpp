// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the XML from which 3D Slicer makes the form of a command.
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber::test;

namespace {

// Returns the commands that --help lists.
std::set<std::string> commands() {
  std::set<std::string> names;
  std::istringstream lines(run_limber({"--help"}).out);
  bool are_next = false;
  const std::regex name(R"(^  ([a-z][a-z-]*) .*)");
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("Subcommands:")) are_next = true;
    else if (std::smatch match; are_next && std::regex_match(line, match, name)) names.insert(match[1]);
  }
  return names;
}

std::set<std::string> all_matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at) found.insert((*at)[1]);
  return found;
}

}  // namespace

TEST_CASE("slicer xml: every command describes itself, by the rules of the execution model") {
  const std::set<std::string> names = commands();
  CHECK(names.size() > 15);
  const bool can_check = has_program("xmllint");
  if (!can_check) MESSAGE("SKIPPED: not checked against the schema: xmllint is not installed");
  for (const std::string& name : names) {
    INFO(name);
    const ProgramRun run = run_limber({name, "--xml"});
    CHECK(run.exit_code == 0);
    CHECK(run.err.empty());
    CHECK(run.out.starts_with("<?xml version=\"1.0\""));
    if (!can_check) continue;
    const TemporaryFolder folder;
    std::ofstream(folder / "described.xml") << run.out;
    const ProgramRun checked = run_program(
        "xmllint",
        {"--noout", "--schema", LIMBER_SOURCE_DIR "/tests/core/cmd/slicer_modules.xsd", folder / "described.xml"});
    INFO(checked.err);
    CHECK(checked.exit_code == 0);
  }
}

TEST_CASE("slicer xml: the options are those of --help") {
  for (const std::string& name : commands()) {
    INFO(name);
    std::set<std::string> shown =
        all_matches(run_limber({name, "--help"}).out, R"((?:^|\n)  (?:-[a-zA-Z],)?(--[a-z][a-z-]*))");
    shown.erase("--help");
    CHECK(all_matches(run_limber({name, "--xml"}).out, "<longflag>([^<]*)<") == shown);
  }
}

TEST_CASE("slicer xml: volumes are volumes, files say their endings, outputs are outputs, choices are listed") {
  const std::string xml = run_limber({"resample", "--xml"}).out;
  const auto part = [&](const std::string& name) {
    const std::size_t at = xml.find("<name>" + name + "</name>");
    REQUIRE(at != std::string::npos);
    const std::size_t begin = xml.rfind("    <", xml.rfind('\n', at) - 1), end = xml.find("\n    </", at);
    return xml.substr(begin, end - begin);
  };
  CHECK(part("VOLUME").find("<image type=\"label\">") != std::string::npos);
  CHECK(part("VOLUME").find("<index>0</index>") != std::string::npos);
  CHECK(part("VOLUME").find("<channel>input</channel>") != std::string::npos);
  CHECK(part("output").find("<image type=\"label\">") != std::string::npos);
  CHECK(part("output").find("<channel>output</channel>") != std::string::npos);
  CHECK(part("rig").find("<file fileExtensions=\".json,") != std::string::npos);
  CHECK(part("method").find("<element>fem</element>") != std::string::npos);
  CHECK(part("contact").find("<boolean>") != std::string::npos);
  CHECK(part("flex").find("multiple=\"true\"") != std::string::npos);
  CHECK(part("mass_limit").find("<string>") != std::string::npos);
}

TEST_CASE("slicer xml: it is asked for by two words only, and else a mistake as any") {
  CHECK(run_limber({"resample", "--xml", "more"}).exit_code == 2);
  CHECK(run_limber({"nothing", "--xml"}).exit_code == 2);
}

TEST_CASE("slicer xml: there is a module for every command") {
  std::set<std::string> modules;
  std::ifstream list(LIMBER_SOURCE_DIR "/core/cmd/slicer_modules.txt");
  for (std::string name; std::getline(list, name);) modules.insert(name);
  CHECK(modules == commands());
}
