// SPDX-License-Identifier: AGPL-3.0-or-later
// Simulates a user who edits a project and sometimes saves it. Edit number n stores n in the root translation of the
// pose, so that the edit from which a recovered document comes is known. Tests run this in a process that they kill, or
// on a simulated disk that loses power.
#pragma once

#include <functional>

#include "core/project/session.h"

namespace limber::test {

struct EditScript {
  int edits = 200;
  double pause = 0.01;  // mean pause between two edits, seconds
  std::uint32_t seed = 0;
  // Called with the edit's number when the session has received the edit.
  std::function<void(int edit)> after_edit;
  // Called with the number of the last edit after each pause. all_kept: the session says that all edits are on the
  // disk.
  std::function<void(int edit, bool all_kept)> after_pause;
};

// Returns the number of the last edit in a document; 0 for the document at the start.
int edit_of(const Document& document);
Document edit_script_start();

// Opens the project, recovers the edits that a killed run left, continues with the next edit, and saves the project
// after about every fortieth edit.
void run_edit_script(const Path& project, const SessionSettings& settings, const EditScript& script);

}  // namespace limber::test
