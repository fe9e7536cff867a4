// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists the source files of the program and of its tests, and their includes, for tests of the dependencies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace limber::layers {

namespace fs = std::filesystem;

struct Include {
  std::string file;  // relative to the root, such as "core/rig/bvh.cpp"
  std::string header;
};

fs::path root();
// Returns the headers and sources in some folders of the root, sorted by path.
std::vector<fs::path> sources(const std::vector<std::string>& folders = {"core", "render", "editor", "tests"});
std::vector<Include> includes_of(const fs::path& file);
std::vector<std::string> lines_of(const fs::path& file);
bool starts_with_any(const std::string& text, const std::vector<std::string>& beginnings);

}  // namespace limber::layers
