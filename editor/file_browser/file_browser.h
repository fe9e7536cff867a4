// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog in which the user selects a file or folder to open or to save. It shows bookmarks at the left, the path of
// the current folder, a list of its entries (name, size, date), and a filter by file type. Typing searches the names.
// The arrow keys, Return, Backspace, Tab and Escape can do all that the mouse can. The dialog opens in the folder that
// was last used for the same purpose.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/context/editor.h"
#include "editor/file_browser/directory_listing.h"

namespace limber::editor {

struct FileRequest {
  enum class Kind { Open, OpenFolder, Save };

  std::string purpose;  // what the file is for; the last folder is remembered for each purpose
  std::string title;
  std::string action;  // the label of the primary button
  Kind kind = Kind::Open;
  std::vector<FileFilter> filters;  // file types to show; the first is active, "All files" is added; saving appends the
                                    // active type's first ending
  std::string name;                 // for saving: the proposed file name
  bool takes_dicom = false;         // whether to offer to open a folder of DICOM images as one volume
  Path folder;                      // folder to begin in if none was used for the purpose yet
  std::function<void(Editor&, const Path&)> chosen;
  std::function<void(Editor&)> left;  // called when the dialog is closed without a selection; may be empty
};

void browse(Editor& editor, FileRequest request);

}  // namespace limber::editor
