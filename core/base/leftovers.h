// SPDX-License-Identifier: AGPL-3.0-or-later
// Files on their way that a killed process could not remove. Each is noted in the user's state folder while it is
// there; the note is locked by its process, and the system gives the lock back however that process ends. So a later
// start of the program knows what nobody owns any more, and removes it.
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber {

// A file or folder that must not outlive its process, unless it is given another name. What is not named as Limber
// names such files (".limber-...", "limber-XXXXXX", "...edits.new") is never removed by a later start.
class Unfinished {
 public:
  // Notes the path, before anything is there. Where no note can be written a later start removes nothing.
  explicit Unfinished(const Path& path);
  // Removes what is there, a file with its journal or a folder with all that is in it, and then the note.
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  Path path_, note_;
  int descriptor_ = -1;
};

// ".limber-PID-NAME" beside `path`, for a file that will take its name.
Path temporary_name(const Path& path);

// Removes what killed processes of this user have left, and their notes. Nothing that a living process owns. Never
// throws.
void remove_leftovers();

}  // namespace limber
