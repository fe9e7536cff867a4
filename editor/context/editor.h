// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor: what is open, how the window is arranged, what the user is doing. Operators change it, panels draw it;
// both get it as their argument. frame() is one turn: take events, dispatch them to operators, draw everything.
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

// What a press of a button began; it gets every move of the pointer until the button is released, or Escape drops it.
struct Drag {
  MouseButton button = MouseButton::Left;
  std::function<void(Editor&, const glm::vec2& pixels)> moved;  // by how much since the last call
  std::function<void(Editor&)> ended, cancelled;
  PointerWrap wrap = {};  // of the view that the drag began in
};

// A press that is still either a click or the beginning of a drag.
struct PendingPress {
  Chord press, drag;
  glm::vec2 from;
  double since;
};

// Something in the middle of the window that everything else waits for; only one at a time.
class Dialog {
 public:
  virtual ~Dialog() = default;
  virtual void draw(Editor& editor) = 0;  // between begin_dialog and end_dialog of dialog.h
  virtual void escape(Editor& editor);    // closes it
  // A key that was pressed, before a text field sees it; true when the dialog took it.
  virtual bool key(Editor&, const Chord&) { return false; }
};

// What is known of a recent file.
struct RecentFacts {
  bool missing = false;
  std::shared_ptr<const render::Image> picture;
};

class LivePose;

// What a click can do to the left button in a view.
enum class Tool { Select, CrossHair, Move, Rotate, Scale, Reach, Extrude };

struct Editor : Ui {
  explicit Editor(Host& host, const Preferences& preferences = {});
  ~Editor();
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  void frame(double now);  // seconds, of any steady clock
  double rest() const;     // seconds that may pass until the next frame when nothing happens; 0: draw on
  bool busy() const;       // with something beside the frames
  bool at_rest() const { return rest() > 0 && !busy(); }

  Arrangement& arrangement() { return arrangements[static_cast<std::size_t>(workspace)]; }
  const Arrangement& arrangement() const { return arrangements[static_cast<std::size_t>(workspace)]; }
  const Document& document() const { return history.current(); }
  // In place of an open one, from the next frame on. One that no act of the user's brought, such as the end of a job,
  // waits until nothing is interrupted by it.
  void open_dialog(std::unique_ptr<Dialog> dialog);
  void close_dialog();
  Host& host;
  Preferences preferences;
  Path preferences_path;             // empty: they are not kept
  bool preferences_problem = false;  // the last time they could not be
  std::string shown_theme;
  Keymap keymap;
  std::vector<Operator> operators;
  std::function<void(Editor&)> before_change = [](Editor&) {
  };  // called before an operator that does not merely look around
  Messages messages;
  bool error_details = false;  // unfolded in the error that is shown

  // The project
  History history;
  Jobs jobs;
  std::map<int, std::function<void(Editor&, const JobStatus&)>> after_job;  // what follows the end of a job, by id
  Path worker_program = "/proc/self/exe";                                   // what runs `limber job`
  bool workers_yield = true;                                                // to everything else on the machine
  std::map<int, Task> tasks;                                                // jobs whose end the editor meets, by id
  std::map<int, StepOfWork> step_of_job;                                    // what a running job is for
  ProjectLife life;
  std::vector<std::function<bool(Editor&)>> each_frame;  // called once a frame until they return false
  Path project_path;                                     // empty: never saved
  std::vector<NamedFile> inputs;  // what the project was read from since it was opened: never written over
  std::string shown_title;        // of the window
  std::string name;               // of the project or of the volume opened last
  std::vector<Path> to_open;      // dropped on the window, or given on the command line

  // Between sittings
  Folders folders;  // empty ones: nothing is kept
  RecentFiles recent_files;
  RecentFilesOnDisk recent_files_on_disk;
  std::map<Path, RecentFacts> recent_facts;
  Pictures pictures;

  // The window
  bool start_screen = false;
  int start_row = 0;  // of its recent files
  Tour tour;
  Workspace workspace = Workspace::Rig;
  Arrangements arrangements;
  Layout layout;
  std::unique_ptr<Dialog> dialog;  // null: none
  bool quit = false;

  // What is seen and done in it
  ImGuiContext* imgui = nullptr;
  std::optional<Views> views;
  Selection selection;
  std::string tissue_search;
  struct {
    std::string search;
    bool searching = false, focus_search = false;
    std::map<std::string, bool> open;  // rows that were folded or unfolded
  } outliner;
  struct {
    std::string name;
    double value = 0;
  } edited_number;  // while it is dragged or typed; the document changes once, at the end
  std::optional<glm::vec3> edited_colour;
  Tool tool = Tool::Select;
  std::unique_ptr<TransformSettings> transform_settings;  // of bones; never null
  std::unique_ptr<SkinDisplay> skin;                      // of weight_display.h; never null
  std::string open_menu;                                  // of the top bar
  std::string open_popup;           // a menu of menus.h wanted at the pointer in the next frame; "" for none
  std::string shown_popup;          // the one that is open
  bool open_pick_list = false;      // likewise
  std::vector<Pickable> pick_list;  // what lies under the pointer, nearest first
  Comparison comparison;
  std::unique_ptr<LivePose> live;
  std::unique_ptr<FemView> fem;                // of fem_live_view.h; never null
  std::unique_ptr<FemOverlay> fem_overlay;     // of fem_overlay.h; never null
  std::unique_ptr<TestPose> trial;             // of test_pose.h; never null
  std::unique_ptr<DifferenceView> difference;  // of difference_overlay.h; never null
  std::unique_ptr<OverlapView> overlap;        // of overlap_overlay.h; never null
  std::unique_ptr<SeamView> seams;             // of seam_view.h; never null
  std::unique_ptr<BoneTable> bone_table;       // of bone_table.h; never null
  struct {
    std::string result;  // whose name is a text field now; "" for none
    std::string text;
    bool focused = false;
  } renaming_result;
  std::vector<KnownResult> known_results;
  struct {
    std::string method = deformation_methods().front().word;
    double spacing = 0;        // mm; 0: as the volume
    bool bones_apart = false;  // joints glide further than a voxel, where their bones need it
    bool mass_exact = false;   // soft tissues keep their volume to the voxel's accuracy
    // Of finite elements.
    bool contact = true;
    std::string quality = "normal";  // "draft", "normal", "fine"
  } resampling;
  struct {
    bool keep_limits = true;                   // joints stop where their limits end
    std::map<std::string, glm::dquat> copied;  // rotations by bone
  } posing;
  struct {
    std::string search;
    std::array<bool, 4> hidden{};  // by severity
    std::size_t lines_seen = 0;
  } console;
  std::map<int, double> stopping_since;  // jobs that were cancelled, by id
  std::optional<Drag> drag;
  std::optional<PendingPress> pending_press;
  std::shared_ptr<Modal> modal;  // null: none
  PointerWrap modal_wrap;
  std::unique_ptr<Timeline> timeline;             // of timeline.h; never null
  Rect timeline_area;                             // its rows in the last picture; empty while it is not shown
  float wheel_rest = 0;                           // of the slices' wheel: parts of a step that a pad has made
  std::string last_operator;                      // id, for Repeat
  std::unique_ptr<LastOperation> last_operation;  // of redo_last_operator.h; never null

  Cursor cursor = Cursor::Arrow;  // of this frame
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
  // What no act of the user's brought, until nothing is interrupted by it.
  std::deque<std::unique_ptr<Dialog>> waiting_dialogs_;
  std::vector<ErrorMessage> waiting_errors_;
  bool of_users_act_ = true;  // what is done now
};

}  // namespace limber::editor
