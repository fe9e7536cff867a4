// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/session.h"

namespace limber::editor {

// How much of the open project has been written to the disk: to its journal (all edits, for recovery) and to its file.
struct ProjectLife {
  std::shared_ptr<Session> session;      // writes the journal; null until there is something to write
  std::int64_t kept_revision = 0;        // the last revision of the history that was passed to the session
  std::int64_t saved_at = 0;             // time of the last save, s since 1970; 0: not saved since the program started
  std::optional<double> unsaved_since;   // start of the autosave interval, s on the editor's clock; none: all saved
  std::string trouble;                   // why edits cannot be written to the journal now; "" when they can
  std::vector<Recoverable> recoverable;  // unsaved work that earlier runs of the program left
};

}  // namespace limber::editor
