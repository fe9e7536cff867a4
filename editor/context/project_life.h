// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/session.h"

namespace limber::editor {

// How much of the open project is on the disk: in its journal (a log of all edits, for recovery after a crash) and in
// its file.
struct ProjectLife {
  std::shared_ptr<Session> session;      // the object that writes the journal; null until there is something to write
  std::int64_t kept_revision = 0;        // the last revision of the undo history that was passed to the session
  std::int64_t saved_at = 0;             // time of the last save, s since 1970; 0: not saved since the program started
  std::optional<double> unsaved_since;   // start of the autosave interval, s on the editor's clock; empty: all is saved
  std::string trouble;                   // why edits cannot be written to the journal now; "" when they can
  std::vector<Recoverable> recoverable;  // unsaved work that earlier runs of the program left
};

}  // namespace limber::editor
