// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/temp_folder.h"

#include <filesystem>

#include "core/base/error.h"
#include "core/platform/file_system.h"

namespace limber::editor {

ScratchFolder::ScratchFolder(const std::string& inside) {
  std::error_code failure;
  const Path base = inside.empty() ? std::filesystem::temp_directory_path(failure) : Path(inside);
  path_ = make_unique_folder(base / "limber-", failure);
  if (failure)
    throw Error("the scratch folder cannot be created", base.string(),
                failure.message() + ": select another folder in the preferences");
  unfinished_ = std::make_unique<Unfinished>(path_);
}

ScratchFolder::~ScratchFolder() = default;

}  // namespace limber::editor
