// SPDX-License-Identifier: AGPL-3.0-or-later
// Removes unfinished files that a killed process left behind. While a process writes a file, a note (a small text file
// in the user's state folder) names that file. The process holds a lock on the note, which the system releases however
// the process ends. So a later start of the program finds the files that no process owns any more and removes them.
#pragma once

#include <string>

#include "core/base/file.h"
#include "core/platform/open_file.h"

namespace limber {

// Owns a temporary file or folder, which must not outlive its process unless it is renamed. When the process is killed,
// a later start of the program removes the file, if it has one of Limber's temporary names (".limber-...",
// "limber-XXXXXX", "...edits.new").
class Unfinished {
 public:
  // Writes a note that names `path`. The note must exist before the file does. When the note cannot be written, a later
  // start of the program removes nothing.
  explicit Unfinished(const Path& path);
  // Removes the file at the path with its "-journal" file, or the folder with its contents, and then the note.
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  Path path_, note_;
  OpenFile locked_;  // the note's file, open and locked
};

// Returns ".limber-PID-NAME" beside `path`, the temporary name of a file that will be renamed to `path`.
Path temporary_name(const Path& path);

// Removes the unfinished files that killed processes of this user left behind, and their notes. Files of a living
// process stay. Never throws.
void remove_leftovers();

}  // namespace limber
