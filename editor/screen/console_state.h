// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace limber::editor {

struct ConsoleState {
  std::string search;
  std::array<bool, 4> hidden{};  // true: messages of a severity are hidden; indexed by severity
  std::size_t lines_seen = 0;
};

}  // namespace limber::editor
