// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/context/operator.h"

namespace limber::editor {

struct OperatorRegistry {
  std::vector<Operator> all;
  // Called before an operator that must not run during playback. It stops the playback.
  std::function<void(Context&)> before_change = [](Context&) {};
  std::string last;  // the id of the operator that the command Repeat runs again
};

}  // namespace limber::editor
