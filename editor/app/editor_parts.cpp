// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/editor_parts.h"

#include "editor/ui/asset_path.h"

namespace limber::editor {

namespace {

constexpr int kJobsAtOnce = 2;

}  // namespace

Editor::Parts::Parts(Host& host, const Preferences& preferences)
    : preferences(preferences),
      keymap(read_keymap(asset("keymap.json"))),
      operators{.all = gather_operators()},
      jobs(kJobsAtOnce, [&host] { host.wake(); }),
      screen{.arrangements = preferences.arrangements} {
  operators.before_change = stop_playing;
}

void Editor::refer_to_parts() {
  Parts& parts = *parts_;
  ui.refer_to(&parts.ui);
  preferences.refer_to(&parts.preferences);
  preferences_state.refer_to(&parts.preferences_state);
  keymap.refer_to(&parts.keymap);
  operators.refer_to(&parts.operators);
  messages.refer_to(&parts.messages);
  history.refer_to(&parts.history);
  jobs.refer_to(&parts.jobs);
  background.refer_to(&parts.background);
  life.refer_to(&parts.life);
  project.refer_to(&parts.project);
  folders.refer_to(&parts.folders);
  recent_files.refer_to(&parts.recent_files);
  pictures.refer_to(&parts.pictures);
  start_screen.refer_to(&parts.start_screen);
  tour.refer_to(&parts.tour);
  screen.refer_to(&parts.screen);
  menus.refer_to(&parts.menus);
  dialogs.refer_to(&parts.dialogs);
  window.refer_to(&parts.window);
  selection.refer_to(&parts.selection);
  pick_list.refer_to(&parts.pick_list);
  outliner.refer_to(&parts.outliner);
  field_edit.refer_to(&parts.field_edit);
  console.refer_to(&parts.console);
  refer_to_rooms();
}

void Editor::refer_to_rooms() {
  Parts& parts = *parts_;
  transform_settings.refer_to(&parts.transform_settings);
  skin.refer_to(&parts.skin);
  comparison.refer_to(&parts.comparison);
  refined.refer_to(&parts.refined);
  fem.refer_to(&parts.fem);
  fem_overlay.refer_to(&parts.fem_overlay);
  trial.refer_to(&parts.trial);
  difference.refer_to(&parts.difference);
  overlap.refer_to(&parts.overlap);
  seams.refer_to(&parts.seams);
  bone_table.refer_to(&parts.bone_table);
  measures.refer_to(&parts.measures);
  results.refer_to(&parts.results);
  resampling.refer_to(&parts.resampling);
  posing.refer_to(&parts.posing);
  interaction.refer_to(&parts.interaction);
  timeline.refer_to(&parts.timeline);
  last_operation.refer_to(&parts.last_operation);
}

}  // namespace limber::editor
