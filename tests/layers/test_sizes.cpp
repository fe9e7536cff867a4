// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks that files and lines are short enough to read easily.
#include <map>
#include <string>

#include <doctest/doctest.h>

#include "tests/layers/sources.h"

using namespace limber::layers;

namespace {

constexpr std::size_t kMostLines = 500, kMostColumns = 120;

// Files that may be longer, each with its reason.
const std::map<std::string, std::string> kLong = {
    {"core/autorig/articulated_fit.cpp", "one solver, whose steps share their state"},
    {"core/autorig/joint_axis_fit.cpp", "one solver, whose steps share their state"},
    {"core/bones/joint_cuts.cpp", "one algorithm in the order of its steps"},
    {"core/deform/preview_map.cpp", "one inner loop in its variants for lanes and blends"},
    {"core/motion/retarget.cpp", "one algorithm in the order of its steps"},
    {"core/paint/brush_region.cpp", "one inner loop in its variants for distances and depths"},
    {"core/paint/stroke.cpp", "one state machine of a stroke"},
    {"core/project/document_reader.cpp", "one reader for each part of a project, all of one shape"},
    {"core/study/html_report.cpp", "one page from top to bottom"},
    {"editor/selection/transform_gizmo.cpp", "one gizmo: drawn, picked and pressed by the same shapes"},
    {"render/view.cpp", "one picture refined over calls, whose steps share their state"},
    {"tests/core/pose/test_body_poses.cpp", "cases of one table"},
    {"tests/editor/rig/test_rig_edits.cpp", "cases on one small rig"},
    {"tests/editor/test_replay.cpp", "cases on one recording"},
    {"tests/editor/viewport/test_gizmos.cpp", "cases on one small rig"},
    {"tests/render/test_view.cpp", "cases on one scene"},
    {"tests/render/textures/test_weights.cpp", "cases on one small body"},
};

// Returns the number of UTF-8 characters in a line, not of bytes.
std::size_t columns_of(const std::string& line) {
  std::size_t columns = 0;
  for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return columns;
}

}  // namespace

TEST_CASE("sizes: no file is longer than 500 lines but those that say why") {
  for (const fs::path& file : sources()) {
    const std::string name = file.generic_string();
    const std::size_t lines = lines_of(file).size();
    INFO(name, " has ", lines, " lines");
    CHECK((lines <= kMostLines) != kLong.contains(name));
  }
}

TEST_CASE("sizes: no line is wider than 120 columns") {
  std::vector<fs::path> files = sources();
  for (const auto& entry : fs::directory_iterator(root() / "render/shaders"))
    files.push_back(fs::relative(entry.path(), root()));
  for (const fs::path& file : files) {
    int number = 0;
    for (const std::string& line : lines_of(file)) {
      ++number;
      if (columns_of(line) <= kMostColumns) continue;
      INFO(file.generic_string(), " line ", number);
      CHECK(columns_of(line) <= kMostColumns);
    }
  }
}
