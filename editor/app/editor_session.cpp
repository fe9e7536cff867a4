// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/editor_session.h"

#include "core/base/error.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/open_project.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/user_folders.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/files/file_filters.h"
#include "editor/files/project_session.h"
#include "editor/resample/refined_pose.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// The recent files are written this long after a change, s. All changes that the user makes within this time are
// written together.
constexpr double kRestBeforeWriting = 1;

Path file_of(const Editor& editor) { return editor.folders->config / "remembered.json"; }

void write_changed(Editor& editor) {
  RecentFilesOnDisk& disk = editor.recent_files_on_disk;
  disk.changed_at.reset();
  disk.contents = editor.recent_files;
  try {
    write_recent_files(editor.recent_files, file_of(editor));
  } catch (const Error& error) {
    if (!disk.failure_told)
      editor.messages->warn("The list of recent files cannot be saved", parts_of(error.what()).where);
    disk.failure_told = true;
  }
}

}  // namespace

void begin_editor_session(Editor& editor, const Folders& folders, std::vector<Path> files) {
  *editor.folders = folders;
  apply_light(editor);
  editor.refined->on = true;
  if (!folders.config.empty()) {
    std::string warning;
    *editor.recent_files = editor.recent_files_on_disk.contents = read_recent_files(file_of(editor), warning);
    if (const ErrorMessage parts = parts_of(warning); !warning.empty())
      editor.messages->warn(parts.what, parts.what_to_do);
  }
  editor.recent_files_on_disk.named = editor.recent_files->recents;
  name_recent_operators(editor);
  look_for_leftovers(editor);
  editor.start_screen->shown = files.empty() && editor.recent_files->show_start;
  if (editor.start_screen->shown) look_at_recents(editor);
  editor.project->to_open = std::move(files);
}

void keep_recent_files(Editor& editor) {
  RecentFilesOnDisk& disk = editor.recent_files_on_disk;
  if (editor.recent_files->recents != disk.named) {
    disk.named = editor.recent_files->recents;
    name_recent_operators(editor);
    if (editor.start_screen->shown) look_at_recents(editor);
  }
  if (editor.folders->config.empty()) return;
  if (editor.recent_files == disk.contents) return disk.changed_at.reset();
  if (!disk.changed_at) disk.changed_at = editor.ui->now;
  if (editor.ui->now - *disk.changed_at >= kRestBeforeWriting) write_changed(editor);
  else editor.ui->wake_at(*disk.changed_at + kRestBeforeWriting);
}

void end_editor_session(Editor& editor) {
  if (!editor.folders->config.empty() && !(editor.recent_files == editor.recent_files_on_disk.contents))
    write_changed(editor);
}

}  // namespace limber::editor
