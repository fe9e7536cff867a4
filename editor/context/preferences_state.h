// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber::editor {

struct PreferencesState {
  Path path;             // file to which the preferences are written; empty: not written
  bool problem = false;  // true: the last attempt to write the preferences failed
  std::string shown_theme;
};

}  // namespace limber::editor
