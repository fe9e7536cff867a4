// SPDX-License-Identifier: AGPL-3.0-or-later
// Scripts of what a user does, played in the real editor with a fixed time step: the same script gives the same
// document and the same pictures. One command a line, "#" begins a comment, names with blanks stand in quotes.
//
//   click NAME [MODIFIER...]         also double-click, right-click; a menu's path opens the menu: click "File/Open..."
//   press NAME | release             the left button alone
//   drag NAME DX DY [BUTTON] [MODIFIER...]   from the widget's middle, pixels at scale 1; BUTTON: LMB, MMB, RMB
//   wheel NAME STEPS [MODIFIER...]
//   move NAME | move X Y
//   key Ctrl+Z                       pressed and released within one frame's time
//   key-down W | key-up W            held meanwhile
//   type "text"
//   drop FILE                        onto the window
//   resize WIDTH HEIGHT
//   wait SECONDS | wait-job | wait-idle
//   expect FACT [VALUE]              facts: fact_names()
//   shot FILE                        a PNG of the window, once it is at rest; of a clip that plays, at once
//   shot-now FILE                    a PNG of what was drawn last, coarse or not
//   frame-log FILE                   what the frames since the last one cost: see frame_timing.h
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "editor/app/headless_window.h"
#include "editor/context/editor.h"

namespace limber::editor {

struct ScriptLine {
  int number = 0;
  std::vector<std::string> words;  // the command first
};
// Throws Error for a quote without an end.
std::vector<ScriptLine> parse_script(const std::string& text);

class Player {
 public:
  Player(Editor& editor, Offscreen& host);

  // Throws Error naming the line that cannot be played, or whose expectation fails. Files are beside `folder`.
  void play(const std::vector<ScriptLine>& script, const Path& folder = ".");
  void play(const std::string& script) { play(parse_script(script)); }
  // Frames until every event has been seen and what they changed is drawn.
  void settle();
  void step();
  double now() const { return now_; }

 private:
  static constexpr double kStep = 1.0 / 60;  // s
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
  std::string doing_ = "beginning";  // the line that is played
};

// A fact about the editor as text: "workspace" is "rig", "history" the number of steps, "text:Muscle" "shown" or
// "absent". Throws Error for an unknown one.
std::string fact(const Editor& editor, const std::string& name);
std::vector<std::string> fact_names();
// The same for equal contents: voxels, tissues, visibility, bones.
std::string document_hash(const Document& document);

}  // namespace limber::editor
