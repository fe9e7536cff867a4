// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/module.h"

#include <cstdlib>
#include <sstream>

#include <dlfcn.h>
#include <unistd.h>

namespace limber {

namespace fs = std::filesystem;

void* open_module(const std::string& name) {
  std::error_code error;
  const Path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return nullptr;
  for (const Path& place : {folder, folder / "../lib/limber"})
    if (void* module = ::dlopen((place / (name + ".so")).c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
  return nullptr;
}

std::optional<Path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const Path program = Path(folder) / name;
    std::error_code error;
    if (program.is_absolute() && fs::is_regular_file(program, error) && ::access(program.c_str(), X_OK) == 0)
      return program;
  }
  return std::nullopt;
}

}  // namespace limber
