// SPDX-License-Identifier: AGPL-3.0-or-later
// Plays scripts of user actions in the real editor with a fixed time step, so that the same script gives the same
// document and the same pictures. A line holds one command, "#" begins a comment, names with spaces stand in quotes.
//
//   click NAME [MODIFIER...]         also double-click, right-click; a menu's path opens the menu: click "File/Open..."
//   press [NAME] | release           presses the left button on NAME or where the pointer is, releases it
//   drag NAME DX DY [BUTTON] [MODIFIER...]   from the widget's centre, px at scale 1; BUTTON: LMB, MMB, RMB
//   wheel NAME STEPS [MODIFIER...]
//   move NAME | move X Y
//   key Ctrl+Z                       pressed and released within one frame's time
//   key-down W | key-up W            the key is held in between
//   type "text"
//   drop FILE                        drops the file on the window
//   resize WIDTH HEIGHT
//   wait SECONDS | wait-job | wait-idle   wait-idle also waits until the pictures are complete and a pose is refined
//   expect FACT [VALUE]              fails unless the fact has this value (default: shown); facts: fact_names()
//   shot FILE                        a PNG of the window once it is idle, or at once while a clip plays
//   shot-now FILE                    a PNG of the last frame drawn, even if still coarse
//   frame-log FILE                   the time of each frame since the last frame-log: see frame_timing.h
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/project/document.h"
#include "editor/app/editor.h"
#include "editor/app/headless_window.h"

namespace limber::editor {

struct ScriptLine {
  int number = 0;
  std::vector<std::string> words;  // the command and its arguments
};
// Splits a script into lines. Throws Error for a quote without an end.
std::vector<ScriptLine> parse_script(const std::string& text);

class Player {
 public:
  Player(Editor& editor, Offscreen& host);

  // Plays the lines. Relative file names in the script start at `folder`. Throws Error if a line cannot be played or
  // its expectation is not met. The error names the line.
  void play(const std::vector<ScriptLine>& script, const Path& folder = ".");
  void play(const std::string& script) { play(parse_script(script)); }
  // Runs frames until all events are handled and their changes are drawn.
  void settle();
  void step();
  double now() const { return now_; }

 private:
  static constexpr double kStep = 1.0 / 60;  // time step, s
  void play_line(const ScriptLine& line, const Path& folder);
  void frame();
  glm::vec2 place_of(const std::string& name);
  void hold(const std::vector<std::string>& words, std::size_t first, bool down);
  void click(const std::string& name, MouseButton button, int times);
  void wait_for_jobs();
  void wait_until_idle();
  void expect(const std::vector<std::string>& words);

  Editor& editor_;
  Offscreen& host_;
  double now_ = 0;
  std::string doing_ = "beginning";  // the line being played, for error messages
};

// Returns a fact about the editor as text. For example, "workspace" gives "rig", "history" gives the number of steps in
// the undo history, and "text:Muscle" gives "shown" or "absent". Throws Error for an unknown name.
std::string fact(const Context& context, const std::string& name);
std::vector<std::string> fact_names();
// Returns a hash of the voxels, tissues, visibility and bones. Equal contents give equal hashes.
std::string document_hash(const Document& document);

}  // namespace limber::editor
