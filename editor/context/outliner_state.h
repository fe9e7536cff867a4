// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>

namespace limber::editor {

struct OutlinerState {
  std::string search;
  bool searching = false, focus_search = false;
  std::map<std::string, bool> open;  // true: the user unfolded a row, false: folded it; by the row's id
  std::string tissue_search;         // search text of the list of tissues
};

}  // namespace limber::editor
