// SPDX-License-Identifier: AGPL-3.0-or-later
// What operators and panels get as their argument: references to the parts of the editor's state. Each part is a struct
// in a header of its own, which only its users include, so that a change of one part rebuilds few sources. A function
// takes the one part that it needs, or a Context if it needs several.
#pragma once

#include "editor/context/context_part.h"

namespace limber {

struct Document;
class History;
class Jobs;

}  // namespace limber

namespace limber::editor {

class Host;
class LivePose;
class Messages;
class Pictures;
struct BackgroundWork;
struct BoneTable;
struct Comparison;
struct ConsoleState;
struct Dialogs;
struct DifferenceView;
struct FemOverlay;
struct FemView;
struct FieldEdit;
struct Folders;
struct Interaction;
struct Keymap;
struct LastOperation;
struct MeasureView;
struct MenuState;
struct OpenProject;
struct OperatorRegistry;
struct OutlinerState;
struct OverlapView;
struct PoseEditing;
struct Preferences;
struct PreferencesState;
struct ProjectLife;
struct RecentFiles;
struct RefinedPose;
struct ResamplingSettings;
struct ResultList;
struct Screen;
struct SeamView;
struct Selection;
struct SkinDisplay;
struct StartScreen;
struct TestPose;
struct Timeline;
struct Tour;
struct TransformSettings;
struct Ui;
struct PickList;
struct Views;
struct WindowState;
enum class Workspace;

struct Context {
  const Document& document() const;  // the current state of the open project
  Workspace workspace() const;       // the workspace that the window shows (context/workspace.h)

  // The window and what the user does in it
  ContextPart<Host> host;                   // declared in context/platform_window.h
  ContextPart<Ui> ui;                       // declared in ui/ui.h
  ContextPart<WindowState> window;          // declared in context/window_state.h
  ContextPart<Screen> screen;               // the regions of the window (context/screen.h)
  ContextPart<MenuState> menus;             // declared in context/menu_state.h
  ContextPart<Dialogs> dialogs;             // declared in context/dialogs.h
  ContextPart<Messages> messages;           // declared in ui/messages.h
  ContextPart<Interaction> interaction;     // the tool, the drag or the modal tool (context/interaction.h)
  ContextPart<FieldEdit> field_edit;        // the field that the user is changing (context/field_edit.h)
  ContextPart<OperatorRegistry> operators;  // declared in context/operator_registry.h
  ContextPart<Keymap> keymap;               // declared in input/keymap.h

  // The open project
  ContextPart<OpenProject> project;        // its name and files (context/open_project.h)
  ContextPart<History> history;            // declared in core/project/history.h
  ContextPart<ProjectLife> life;           // how much of the project is on the disk (context/project_life.h)
  ContextPart<Jobs> jobs;                  // declared in core/project/job.h
  ContextPart<BackgroundWork> background;  // tasks, and what is done when a job ends (context/background_task.h)

  // Settings and lists that are stored on disk between runs of the program
  ContextPart<Preferences> preferences;             // declared in context/preferences.h
  ContextPart<PreferencesState> preferences_state;  // the preferences' file (context/preferences_state.h)
  ContextPart<Folders> folders;                     // declared in context/user_folders.h
  ContextPart<RecentFiles> recent_files;            // declared in context/recent_files.h
  ContextPart<Pictures> pictures;                   // small pictures of files (ui/texture_cache.h)

  // What the views and panels show
  ContextPart<Views> views;               // declared in context/views.h
  ContextPart<Selection> selection;       // declared in context/selection.h
  ContextPart<PickList> pick_list;        // what is under the pointer (context/pick_list.h)
  ContextPart<OutlinerState> outliner;    // declared in context/outliner_state.h
  ContextPart<StartScreen> start_screen;  // declared in context/start_screen_state.h
  ContextPart<Tour> tour;                 // declared in context/tour_progress.h
  ContextPart<ConsoleState> console;      // declared in screen/console_state.h
  ContextPart<Comparison> comparison;     // two results side by side (context/comparison.h)

  // Settings and state of single tools and panels
  ContextPart<TransformSettings> transform_settings;  // how tools transform bones (context/transform_settings.h)
  ContextPart<BoneTable> bone_table;                  // which rig bone each bone label follows (rig/bone_table.h)
  ContextPart<SkinDisplay> skin;                      // how the Skin workspace shows weights (skin/weight_display.h)
  ContextPart<TestPose> trial;                        // settings of the test pose (shown/test_pose.h)
  ContextPart<Timeline> timeline;                     // playback, keys and the shown frame (motion/timeline.h)
  ContextPart<PoseEditing> posing;                    // declared in context/pose_editing.h
  ContextPart<LastOperation> last_operation;   // what can be redone with other numbers (dialogs/redo_last_operator.h)
  ContextPart<LivePose> live;                  // the posed body while it is posed (pose/live_preview.h)
  ContextPart<RefinedPose> refined;            // the posed body at rest (resample/refined_pose.h)
  ContextPart<FemView> fem;                    // the running FEM solves and the shown one (shown/fem_live_view.h)
  ContextPart<FemOverlay> fem_overlay;         // the shown FEM measure and mesh (resample/fem_overlay.h)
  ContextPart<ResamplingSettings> resampling;  // declared in context/resampling_settings.h
  ContextPart<ResultList> results;             // declared in resample/result_list.h
  ContextPart<DifferenceView> difference;      // the comparison of two volumes (resample/difference_overlay.h)
  ContextPart<OverlapView> overlap;            // the shown overlap of a result (resample/overlap_overlay.h)
  ContextPart<SeamView> seams;                 // the shown seams and the seam brush (seams/seam_view.h)
  ContextPart<MeasureView> measures;           // the shown measurements (measure/measure_view.h)
};

}  // namespace limber::editor
