// SPDX-License-Identifier: AGPL-3.0-or-later
// Opens, saves and recovers the project. Tracks the project's file, the edits that this file contains, and the journal,
// which stores every edit between saves (core/project/session.h). Tasks read and write files while the editor stays
// responsive.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/named_files.h"
#include "core/project/session.h"

namespace limber::editor {

struct Context;
struct Extents;

using Then = std::function<void(Context&)>;

// A project's state as read from a file, ready to replace the open project.
struct Opened {
  Document document;
  std::string name;                        // project name in the top bar
  std::string label;                       // label of the first step in the undo history
  std::shared_ptr<Session> session;        // keeps the journal of edits; null: started when needed
  std::string editor;                      // views and layout, as JSON (view_state_json.h)
  std::shared_ptr<const Extents> extents;  // bounding boxes of the tissues; null: computed when needed
  bool unsaved = false;                    // true: the project has unsaved edits, as after a recovery
  std::int64_t agreed = 0;                 // revision of the open project when the user agreed to replace it
  bool recover = false;                    // true: recover edits left by a crash without asking
  Then then;                               // called after the project is open
  std::vector<NamedFile> inputs;           // files that were read if there is no project file
};
void replace_project(Context& context, std::shared_ptr<Opened> opened);

// Asks whether to save unsaved edits (Save, Don't save, Cancel), then calls `go_on`. Without unsaved edits, calls
// `go_on` at once.
void ask_about_unsaved(Context& context, Then go_on);
void new_project(Context& context);
enum class Leftover { Ask, Recover };  // what to do with edits left by a crash
void open_project(Context& context, const Path& path, Then then = {}, Leftover leftover = Leftover::Ask);

// Saves the project; asks for a file name if it has none.
void save_project(Context& context, Then then = {});
void save_project_as(Context& context, const Path& path, Then then = {});
void save_project_copy(Context& context, const Path& path);
void ask_where_to_save(Context& context, Then then = {});

// Find, recover or discard the edits left by sessions that ended in a crash.
void look_for_leftovers(Context& context);
void recover(Context& context, const Recoverable& leftover);
void discard_leftover(Context& context, const Recoverable& leftover);

// Writes new edits to the journal, and shows a message if they cannot be stored. Call once per frame.
void keep_edits(Context& context);

}  // namespace limber::editor
