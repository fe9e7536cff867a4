// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog in which the user selects a file or folder to open or to save. It shows bookmarks at the left, the path of
// the current folder, a list of its entries (name, size, date), and a filter by file type. Typing searches the names.
// The arrow keys, Return, Backspace, Tab and Escape can do all that the mouse can. The dialog opens in the folder that
// was last used for the same purpose.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/file_browser/directory_listing.h"

namespace limber::editor {

struct Context;

struct FileRequest {
  enum class Kind { Open, OpenFolder, Save };

  std::string purpose;  // id of the file's purpose; the dialog opens in the last folder used for this purpose
  std::string title;
  std::string action;  // the label of the primary button
  Kind kind = Kind::Open;
  // File types that the user can select; the first is active when the dialog opens. The dialog adds "All files" at the
  // end. A saved file gets the first ending of the active type.
  std::vector<FileFilter> filters;
  std::string name;          // file name that a Save dialog proposes
  bool takes_dicom = false;  // true: the dialog offers to open a folder of DICOM images as one volume
  Path folder;               // initial folder if the user has not selected a file for this purpose before
  std::function<void(Context&, const Path&)> chosen;
  std::function<void(Context&)> left;  // called when the dialog is closed without a selection; may be empty
};

void browse(Context& context, FileRequest request);

}  // namespace limber::editor
