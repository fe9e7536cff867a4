// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog in which files and folders are chosen, to open or to save: places at the left, the folder's path above a
// list of name, size and date, a filter by type. Typing searches names; arrows, Return, Backspace, Tab and Escape do
// all that the mouse does. It begins where it was left for the same purpose.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/context/editor.h"
#include "editor/file_browser/directory_listing.h"

namespace limber::editor {

struct FileRequest {
  enum class Kind { Open, OpenFolder, Save };

  std::string purpose;  // where one was is remembered for each
  std::string title;
  std::string action;  // the primary button's word
  Kind kind = Kind::Open;
  std::vector<FileFilter> filters;  // the first is chosen; "All files" is added; when saving, its first end is appended
  std::string name;                 // proposed, when saving
  bool takes_dicom = false;         // a folder of DICOM images is offered to be opened as one
  Path folder;                      // to begin in, where the purpose has none yet
  std::function<void(Editor&, const Path&)> chosen;
  std::function<void(Editor&)> left;  // without a choice; may be empty
};

void browse(Editor& editor, FileRequest request);

}  // namespace limber::editor
