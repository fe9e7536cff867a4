// SPDX-License-Identifier: AGPL-3.0-or-later
// The parts of the editor's state, which Editor owns and a Context refers to.
#pragma once

#include <optional>

#include "core/project/history.h"
#include "core/project/job.h"
#include "editor/app/editor.h"
#include "editor/context/background_task.h"
#include "editor/context/comparison.h"
#include "editor/context/dialogs.h"
#include "editor/context/field_edit.h"
#include "editor/context/frame_timing.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/modal_tool.h"
#include "editor/context/open_project.h"
#include "editor/context/operator_registry.h"
#include "editor/context/outliner_state.h"
#include "editor/context/pick_list.h"
#include "editor/context/pose_editing.h"
#include "editor/context/preferences.h"
#include "editor/context/preferences_state.h"
#include "editor/context/project_life.h"
#include "editor/context/recent_files.h"
#include "editor/context/resampling_settings.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/tour_progress.h"
#include "editor/context/transform_settings.h"
#include "editor/context/user_folders.h"
#include "editor/context/views.h"
#include "editor/context/window_state.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/input/keymap.h"
#include "editor/measure/measure_view.h"
#include "editor/motion/timeline.h"
#include "editor/pose/live_preview.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/overlap_overlay.h"
#include "editor/resample/refined_pose.h"
#include "editor/resample/result_list.h"
#include "editor/rig/bone_table.h"
#include "editor/screen/console_state.h"
#include "editor/seams/seam_view.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/messages.h"
#include "editor/ui/texture_cache.h"
#include "editor/ui/ui.h"

namespace limber::editor {

// Members are destroyed in reverse order of their declaration. A member whose destructor waits for threads is therefore
// declared after the members that those threads use.
struct Editor::Parts {
  Parts(Host& host, const Preferences& preferences);

  Ui ui;
  Preferences preferences;
  PreferencesState preferences_state;
  Keymap keymap;
  OperatorRegistry operators;
  Messages messages;

  History history;
  Jobs jobs;
  BackgroundWork background;
  ProjectLife life;
  OpenProject project;

  Folders folders;
  RecentFiles recent_files;
  Pictures pictures;

  StartScreen start_screen;
  Tour tour;
  Screen screen;
  MenuState menus;
  Dialogs dialogs{ui};
  WindowState window;

  std::optional<Views> views;  // no value while there is no OpenGL context
  Selection selection;
  PickList pick_list;
  OutlinerState outliner;
  FieldEdit field_edit;
  ConsoleState console;
  TransformSettings transform_settings;
  SkinDisplay skin;
  Comparison comparison;
  std::optional<LivePose> live;  // always has a value after the editor's construction
  RefinedPose refined;
  FemView fem;
  FemOverlay fem_overlay;
  TestPose trial;
  DifferenceView difference;
  OverlapView overlap;
  SeamView seams;
  BoneTable bone_table;
  MeasureView measures;
  ResultList results;
  ResamplingSettings resampling;
  PoseEditing posing;
  Interaction interaction;
  Timeline timeline;
  LastOperation last_operation;
};

}  // namespace limber::editor
