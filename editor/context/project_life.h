// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/session.h"

namespace limber::editor {

// Which file the project is, and what of it is kept.
struct ProjectLife {
  std::shared_ptr<Session> session;      // null until there is something to keep
  std::int64_t kept_revision = 0;        // handed to the session last
  std::int64_t saved_at = 0;             // s since 1970; 0: not in this sitting
  std::optional<double> unsaved_since;   // the editor's time; none: nothing is unsaved
  std::string trouble;                   // why edits are not kept just now; "" when they are
  std::vector<Recoverable> recoverable;  // what earlier sittings left
};

}  // namespace limber::editor
