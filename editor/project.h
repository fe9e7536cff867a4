// SPDX-License-Identifier: AGPL-3.0-or-later
// What is open: volumes and their tissues come in through jobs beside the live editor; their edits and failures are met
// here, once a frame.
#pragma once

#include "editor/editor.h"

namespace limber::editor {

// The files that were dropped or given on the command line.
void open_waiting_files(Editor& editor);
// Commits what jobs have done and tells of those that failed. True when anything changed.
bool poll_jobs(Editor& editor);
// An edit of the user's own: commits the document and shows it.
void commit(Editor& editor, const std::string& label, Document next);
// Puts cameras and cross-hair where the whole body is seen.
void frame_all(Editor& editor, bool animated);

// The user's scale times the monitor's, or less where the window is too small for it: the regions need 800 x 520.
float scale_for(const Preferences& preferences, const Host& host);
// Follows a change of the theme or scale. True when the look changed.
bool apply_look_if_changed(Editor& editor);

}  // namespace limber::editor
