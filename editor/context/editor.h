// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor's whole state: the open project, the window's arrangement, the user's current action. Operators change
// this state and panels draw it; both get an Editor as their argument. frame() takes the input events, runs the
// operators that they are bound to, and draws everything.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/named_files.h"
#include "core/platform/module.h"
#include "core/project/history.h"
#include "core/project/job.h"
#include "core/resample/deformation_method.h"
#include "editor/context/background_task.h"
#include "editor/context/comparison.h"
#include "editor/context/cursor_wrap.h"
#include "editor/context/layout.h"
#include "editor/context/modal_tool.h"
#include "editor/context/operator.h"
#include "editor/context/platform_window.h"
#include "editor/context/preferences.h"
#include "editor/context/project_life.h"
#include "editor/context/recent_files.h"
#include "editor/context/tour_progress.h"
#include "editor/context/user_folders.h"
#include "editor/context/views.h"
#include "editor/input/keymap.h"
#include "editor/ui/messages.h"
#include "editor/ui/texture_cache.h"
#include "editor/ui/ui.h"

struct ImGuiContext;

namespace limber::editor {

struct Timeline;
struct TransformSettings;
struct LastOperation;
struct SkinDisplay;
struct FemView;
struct FemOverlay;
struct TestPose;
struct DifferenceView;
struct OverlapView;
struct SeamView;
struct BoneTable;
struct MeasureView;

// A drag with a mouse button. `moved` is called for every move of the pointer until the button is released (then
// `ended` is called) or Escape cancels the drag (then `cancelled` is called).
struct Drag {
  MouseButton button = MouseButton::Left;
  std::function<void(Editor&, const glm::vec2& pixels)> moved;  // `pixels`: pointer motion since the last call
  std::function<void(Editor&)> ended, cancelled;
  PointerWrap wrap = {};  // moves the pointer back into the view in which the drag began
};

// A press of a mouse button that may still become a click or a drag.
struct PendingPress {
  Chord press, drag;
  glm::vec2 from;
  double since;
};

// A dialog in the middle of the window. It blocks everything else; only one dialog is open at a time.
class Dialog {
 public:
  virtual ~Dialog() = default;
  virtual void draw(Editor& editor) = 0;  // calls begin_dialog() and end_dialog() of dialog.h
  virtual void escape(Editor& editor);    // closes the dialog; called when the user presses Escape
  // Handles a pressed key before a text field of the dialog gets it. Returns true if the dialog used the key.
  virtual bool key(Editor&, const Chord&) { return false; }
};

// What the start screen shows about a recent file: a small picture of it, and whether the file is missing.
struct RecentFacts {
  bool missing = false;
  std::shared_ptr<const render::Image> picture;
};

class LivePose;

// The tools of the tool strip. The selected tool decides what the left mouse button does in a view.
enum class Tool { Select, CrossHair, Move, Rotate, Scale, Reach, Extrude };

struct Editor : Ui {
  explicit Editor(Host& host, const Preferences& preferences = {});
  ~Editor();
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  void frame(double now);  // draws one frame; `now`: time of the frame on a steady clock, s
  double rest() const;     // time until the next frame if no input arrives, s; 0: draw at once
  bool busy() const;       // true while a thread or process works for the editor
  bool at_rest() const { return rest() > 0 && !busy(); }

  Arrangement& arrangement() { return arrangements[static_cast<std::size_t>(workspace)]; }
  const Arrangement& arrangement() const { return arrangements[static_cast<std::size_t>(workspace)]; }
  const Document& document() const { return history.current(); }
  // Opens a dialog in the next frame and closes the dialog that is open. A dialog that opens without an action of the
  // user's, such as at the end of a job, waits until it does not interrupt the user.
  void open_dialog(std::unique_ptr<Dialog> dialog);
  void close_dialog();
  Host& host;
  Preferences preferences;
  Path preferences_path;             // file of the preferences; empty: they are not written
  bool preferences_problem = false;  // true: the last attempt to write the preferences failed
  std::string shown_theme;
  Keymap keymap;
  std::vector<Operator> operators;
  // Called before an operator that must not run during playback. It stops the playback.
  std::function<void(Editor&)> before_change = [](Editor&) {};
  Messages messages;
  bool error_details = false;  // true: the details of the shown error are unfolded

  // The project
  History history;
  Jobs jobs;
  std::map<int, std::function<void(Editor&, const JobStatus&)>> after_job;  // called when a job of this id ends
  Path worker_program = running_program();                                  // the program that runs `limber job`
  bool workers_yield = true;              // true: worker processes run at low priority
  std::map<int, Task> tasks;              // background tasks, by the id of their job
  std::map<int, StepOfWork> step_of_job;  // workflow step in which a job was started, by the job's id
  ProjectLife life;
  // Functions that are called once in every frame. A function that returns false is removed.
  std::vector<std::function<bool(Editor&)>> each_frame;
  Path project_path;              // file of the project; empty: never saved
  std::vector<NamedFile> inputs;  // files from which the project's data was read; they are never overwritten
  std::string shown_title;        // the window's title
  std::string name;               // the name of the project, or of the volume opened last
  std::vector<Path> to_open;      // files dropped on the window or given on the command line

  // Stored on disk between runs of the program
  Folders folders;  // folders of the editor's own files; an empty path: files of that kind are not stored
  RecentFiles recent_files;
  RecentFilesOnDisk recent_files_on_disk;
  std::map<Path, RecentFacts> recent_facts;
  Pictures pictures;

  // The window
  bool start_screen = false;
  int start_row = 0;  // index of the recent file that is selected on the start screen
  Tour tour;
  Workspace workspace = Workspace::Rig;
  Arrangements arrangements;
  Layout layout;
  std::unique_ptr<Dialog> dialog;  // the open dialog; null: none
  bool quit = false;

  // The user's selection, tool and other state of what is shown in the window
  ImGuiContext* imgui = nullptr;
  std::optional<Views> views;
  Selection selection;
  std::string tissue_search;
  struct {
    std::string search;
    bool searching = false, focus_search = false;
    std::map<std::string, bool> open;  // true: the user unfolded a row, false: folded it; by the row's id
  } outliner;
  struct {
    std::string name;
    double value = 0;
  } edited_number;  // the number field that the user drags or types in; the document changes once, at the end
  std::optional<glm::vec3> edited_colour;
  Tool tool = Tool::Select;
  std::unique_ptr<TransformSettings> transform_settings;  // how tools transform bones; never null
  // How the Skin workspace shows weights (weight_display.h); never null.
  std::unique_ptr<SkinDisplay> skin;
  std::string open_menu;            // title of the top bar's open menu; "" for none
  std::string open_popup;           // the menu of menus.h to open at the pointer in the next frame; "" for none
  std::string shown_popup;          // the menu of menus.h that is open; "" for none
  bool open_pick_list = false;      // true: the list of bones and tissues under the pointer opens in the next frame
  std::vector<Pickable> pick_list;  // bones and tissues under the pointer, nearest first
  Comparison comparison;
  std::unique_ptr<LivePose> live;
  // The running FEM solves and the one that is shown (fem_live_view.h); never null.
  std::unique_ptr<FemView> fem;
  std::unique_ptr<FemOverlay> fem_overlay;     // the shown FEM measure and mesh (fem_overlay.h); never null
  std::unique_ptr<TestPose> trial;             // settings of the test pose, declared in test_pose.h; never null
  std::unique_ptr<DifferenceView> difference;  // the comparison of two volumes (difference_overlay.h); never null
  std::unique_ptr<OverlapView> overlap;        // the shown overlap of a result (overlap_overlay.h); never null
  std::unique_ptr<SeamView> seams;             // the shown seams and the seam brush (seam_view.h); never null
  std::unique_ptr<BoneTable> bone_table;       // which rig bone each bone label follows (bone_table.h); never null
  std::unique_ptr<MeasureView> measures;       // the shown measurements (measure_view.h); never null
  struct {
    std::string result;  // the result whose name is being edited; "" for none
    std::string text;
    bool focused = false;
  } renaming_result;
  std::vector<KnownResult> known_results;
  struct {
    std::string method = deformation_methods().front().word;
    double spacing = 0;        // voxel size of the posed volume, mm; 0: as in the volume at rest
    bool bones_apart = false;  // true: joints may shift by more than a voxel so that bones do not overlap
    bool mass_exact = false;   // true: each soft tissue keeps its volume, exact to a voxel
    // Options of the method "finite elements"
    bool contact = true;
    std::string quality = "normal";  // quality of the FEM mesh: "draft", "normal" or "fine"
  } resampling;
  struct {
    bool keep_limits = true;                   // true: joints stop at their limits
    std::map<std::string, glm::dquat> copied;  // the copied pose: rotation of each bone, by the bone's name
  } posing;
  struct {
    std::string search;
    std::array<bool, 4> hidden{};  // true: messages of a severity are hidden; indexed by severity
    std::size_t lines_seen = 0;
  } console;
  std::map<int, double> stopping_since;  // time at which a job that still runs was cancelled, s, by the job's id
  std::optional<Drag> drag;
  std::optional<PendingPress> pending_press;
  std::shared_ptr<Modal> modal;  // the modal tool that gets all input; null: none
  PointerWrap modal_wrap;
  std::unique_ptr<Timeline> timeline;  // playback, keys and the shown frame (timeline.h); never null
  Rect timeline_area;         // area of the timeline's rows in the last frame; empty while the timeline is not shown
  Rect graph_area;            // the part of timeline_area in which the graph editor draws curves; empty: not shown
  float wheel_rest = 0;       // fraction of a wheel step that has not moved a slice yet; touch pads send fractions
  std::string last_operator;  // the id of the operator that the command Repeat runs again
  // The operation that can be redone with other numbers (redo_last_operator.h); never null.
  std::unique_ptr<LastOperation> last_operation;

  Cursor cursor = Cursor::Arrow;  // the pointer's shape in this frame
  int hovered_splitter = -1;
  double splitter_since = 0;

 private:
  void take_input();
  void read_typed_text();
  void meet_jobs();
  void draw_views();
  void draw();
  void change_dialog();
  std::optional<std::unique_ptr<Dialog>> next_dialog_;
  // Dialogs and errors that no action of the user's caused. They are shown once they do not interrupt the user.
  std::deque<std::unique_ptr<Dialog>> waiting_dialogs_;
  std::vector<ErrorMessage> waiting_errors_;
  bool of_users_act_ = true;  // true: what happens now was caused by an action of the user's
};

}  // namespace limber::editor
