// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor: it owns the parts of a Context and draws the frames. frame() takes the input events, runs the operators
// that they are bound to, and draws everything. Operators and panels do not use the class Editor; they get a Context.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "editor/context/context.h"
#include "editor/context/preferences.h"
#include "editor/context/recent_files.h"
#include "editor/ui/messages.h"

namespace limber::editor {

class Editor : public Context {
 public:
  explicit Editor(Host& host, const Preferences& preferences = {});
  ~Editor();
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  void frame(double now);  // draws one frame; `now`: time of the frame on a steady clock, s
  double rest() const;     // time until the next frame if no input arrives, s; 0: draw at once
  bool busy() const;       // true while a thread or process works for the editor
  bool at_rest() const;    // true if nothing will change without input

  RecentFilesOnDisk recent_files_on_disk;

 private:
  struct Parts;

  void refer_to_parts();
  void refer_to_rooms();
  void take_input();
  void read_typed_text();
  void meet_jobs();
  void draw_views();
  void draw();

  std::unique_ptr<Parts> parts_;
  // Errors that no action of the user's caused. They are shown once they do not interrupt the user.
  std::vector<ErrorMessage> waiting_errors_;
  std::string shown_title_;  // the window's title
};

}  // namespace limber::editor
