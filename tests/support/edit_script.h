// SPDX-License-Identifier: AGPL-3.0-or-later
// A session in which someone works: edits, now and then a save. Edit number n leaves n in the pose's root translation,
// so what comes back tells how far it reached. Run in a process of its own, to be killed, or over disks that lose
// power.
#pragma once

#include <functional>

#include "core/project/session.h"

namespace limber::test {

struct EditScript {
  int edits = 200;
  double pause = 0.01;  // seconds between two, on average
  std::uint32_t seed = 0;
  std::function<void(int edit)> after_edit;                  // it was handed to the session
  std::function<void(int edit, bool all_kept)> after_pause;  // and whether the session says it is on the disk
};

// The edit that a document comes from; 0 for the one at the start.
int edit_of(const Document& document);
Document edit_script_start();

// Opens the project, recovers what there is, goes on with the edits and saves about every fortieth.
void run_edit_script(const Path& project, const SessionSettings& settings, const EditScript& script);

}  // namespace limber::test
