// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/main_loop.h"

#include <chrono>

#include "editor/app/editor_session.h"
#include "editor/app/glfw_window.h"
#include "editor/app/headless_window.h"
#include "editor/app/script_player.h"
#include "editor/context/operator.h"
#include "editor/context/preferences_state.h"
#include "editor/context/project_life.h"
#include "editor/context/user_folders.h"
#include "editor/context/window_state.h"

namespace limber::editor {

namespace {

// Time between frames while the window is minimized, s. In these frames nothing is drawn, but finished jobs are
// handled.
constexpr double kMinimizedRest = 0.25;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Preferences with_options(Preferences preferences, const StartOptions& options) {
  if (options.scale) preferences.scale = glm::clamp(*options.scale, 0.75, 3.0);
  if (options.theme) preferences.theme = *options.theme;
  return preferences;
}

void play(const StartOptions& options) {
  const auto script = parse_script(read_file(options.script));
  const auto host = open_offscreen(options.size);
  Editor editor(*host, with_options({}, options));
  begin_editor_session(editor, user_folders(), options.files);
  Player player(editor, *host);
  player.step();
  player.play({{0, {"wait-job"}}});
  // Discards the journal of the script's edits when the script ends, so that only a script that was killed leaves edits
  // to recover.
  struct Ending {
    Editor& editor;
    ~Ending() {
      if (editor.life->session) editor.life->session->discard();
      end_editor_session(editor);
    }
  } ending{editor};
  player.play(script, options.script.parent_path());
}

void run_in_window(const StartOptions& options) {
  const auto host = open_window(options.size, "Limber");
  std::string problem;
  Editor editor(*host, with_options(read_preferences(preferences_path(), problem), options));
  editor.preferences_state->path = preferences_path();
  if (!problem.empty()) editor.messages->warn("Preferences could not be read", problem);
  begin_editor_session(editor, user_folders(), options.files);
  while (!editor.window->quit) {
    const bool minimized = host->size().x == 0 || host->size().y == 0;
    host->wait(minimized ? kMinimizedRest : editor.rest());
    if (host->close_requested()) {
      host->forget_close_request();
      run(editor, "file.quit");
    }
    editor.frame(steady_seconds());
  }
  end_editor_session(editor);
}

}  // namespace

void run_editor(const StartOptions& options) { options.script.empty() ? run_in_window(options) : play(options); }

}  // namespace limber::editor
