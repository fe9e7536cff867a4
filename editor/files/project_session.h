// SPDX-License-Identifier: AGPL-3.0-or-later
// From the first edit to the last save: which file the project is, what of it is saved, and the journal that keeps
// every edit meanwhile (core/project/session.h). Reading and writing are tasks beside the live editor.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/named_files.h"
#include "core/project/session.h"
#include "editor/context/editor.h"

namespace limber::editor {

using Then = std::function<void(Editor&)>;

// A project's state as it was read, to take the open one's place.
struct Opened {
  Document document;
  std::string name;                        // shown in the top bar
  std::string label;                       // the first step of the history
  std::shared_ptr<Session> session;        // of a project's file; null for one that has none yet
  std::string editor;                      // its views and layout
  std::shared_ptr<const Extents> extents;  // of its volume; null: found when they are needed
  bool unsaved = false;                    // as after a recovery
  std::int64_t agreed = 0;                 // the revision that the user agreed to leave
  bool recover = false;                    // what a crash left of it is wanted, and needs no question
  Then then;                               // what goes on after it
  std::vector<NamedFile> inputs;           // what it was read from, without a project's file
};
void replace_project(Editor& editor, std::shared_ptr<Opened> opened);

// Asks whether unsaved edits are to be saved (Save, Don't save, Cancel) before `go_on`; at once when there are none.
void ask_about_unsaved(Editor& editor, Then go_on);
void new_project(Editor& editor);
enum class Leftover { Ask, Recover };  // what a crash left of the project
void open_project(Editor& editor, const Path& path, Then then = {}, Leftover leftover = Leftover::Ask);

// Asks for a name when it has none.
void save_project(Editor& editor, Then then = {});
void save_project_as(Editor& editor, const Path& path, Then then = {});
void save_project_copy(Editor& editor, const Path& path);
void ask_where_to_save(Editor& editor, Then then = {});

// Leftovers of sittings that did not end well.
void look_for_leftovers(Editor& editor);
void recover(Editor& editor, const Recoverable& leftover);
void discard_leftover(Editor& editor, const Recoverable& leftover);

// Once a frame: hands new edits to the journal, and tells of trouble with it.
void keep_edits(Editor& editor);

}  // namespace limber::editor
