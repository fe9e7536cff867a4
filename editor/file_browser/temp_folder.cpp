// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/temp_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/base/error.h"

namespace limber::editor {

ScratchFolder::ScratchFolder(const std::string& inside) {
  std::error_code failure;
  const Path base = inside.empty() ? std::filesystem::temp_directory_path(failure) : Path(inside);
  std::string name = (base / "limber-XXXXXX").string();
  if (!::mkdtemp(name.data()))
    throw Error("the scratch folder cannot be created", base.string(),
                std::string(std::strerror(errno)) + ": select another one in the preferences");
  path_ = name;
  unfinished_ = std::make_unique<Unfinished>(path_);
}

ScratchFolder::~ScratchFolder() = default;

}  // namespace limber::editor
