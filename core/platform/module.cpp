// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/module.h"

#include <cstdlib>
#include <sstream>
#include <vector>

#include <dlfcn.h>
#include <unistd.h>

namespace limber {

namespace fs = std::filesystem;

namespace {
// Returns the folders that may contain Limber's modules and helper programs: the folder of the shared object with this
// code, the folder of the running program, ../lib/limber relative to the latter, and lib/limber where Limber was
// installed. The last folder is for other programs that use Limber as a library.
std::vector<Path> own_folders() {
  const Path folder = running_program_path().parent_path();
  if (folder.empty()) return {};
  std::vector<Path> folders = {folder, folder / "../lib/limber", Path(LIMBER_INSTALLED_IN) / "lib/limber"};
  if (const Path own = own_shared_object(); !own.empty()) folders.insert(folders.begin(), own.parent_path());
  return folders;
}

bool is_program(const Path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}
}  // namespace

Path own_shared_object() {
  Dl_info info{};
  if (!::dladdr(reinterpret_cast<void*>(&own_shared_object), &info) || !info.dli_fname) return {};
  const Path file = info.dli_fname;
  return file.is_absolute() && file.extension() == ".so" ? file : Path();
}

void* open_module(const std::string& name) {
  for (const Path& folder : own_folders())
    if (void* module = ::dlopen((folder / (name + ".so")).c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
  return nullptr;
}

std::optional<Path> find_own_program(const std::string& name) {
  for (const Path& folder : own_folders())
    if (is_program(folder / name)) return folder / name;
  return std::nullopt;
}

std::optional<Path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const Path program = Path(folder) / name;
    if (program.is_absolute() && is_program(program)) return program;
  }
  return std::nullopt;
}

Path running_program_path() {
  std::error_code ignored;
  return fs::read_symlink(running_program(), ignored);
}

Path running_program() { return "/proc/self/exe"; }

void* symbol_of(void* module, const char* name) { return ::dlsym(module, name); }

void* symbol_of_program(const char* name) { return ::dlsym(RTLD_DEFAULT, name); }

}  // namespace limber
