// SPDX-License-Identifier: AGPL-3.0-or-later
// The sources of the program and of its tests, and what they include, for tests of how the tree is built.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace limber::layers {

namespace fs = std::filesystem;

struct Include {
  std::string file;  // from the root, "core/rig/bvh.cpp"
  std::string header;
};

fs::path root();
// Headers and sources below folders of the root, in order of their paths.
std::vector<fs::path> sources(const std::vector<std::string>& folders = {"core", "render", "editor", "tests"});
std::vector<Include> includes_of(const fs::path& file);
std::vector<std::string> lines_of(const fs::path& file);
bool starts_with_any(const std::string& text, const std::vector<std::string>& beginnings);

}  // namespace limber::layers
