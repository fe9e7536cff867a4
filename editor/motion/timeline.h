// SPDX-License-Identifier: AGPL-3.0-or-later
// The timeline: the shown frame, playing, and edits of the shown clip. The document's pose is the clip's pose at the
// document's frame, until the user changes the pose. Going to another frame is one edit that takes the pose from the
// clip again. Consecutive frame changes are merged into one edit, so that undo restores the frame and the pose before
// them.
//
// While the user drags the play head, and while the clip plays, the frame is previewed (preview_pose of Views) and not
// yet stored; it is stored in the document when the play head stops. A playing clip always shows the frame of the
// current time: when drawing is slow, frames are skipped and the clip keeps its speed.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/project/document.h"
#include "editor/ui/rect.h"

namespace limber::editor {

struct Context;

enum class AtEnd { Stop, Loop, PingPong };

class FrameLog;
struct OnionOutlines;
struct MotionPaths;
struct Graph;
struct StripView;
struct HandPoses;

struct Timeline {
  // The previewed frame that replaces the document's frame while the user scrubs or the clip plays.
  std::optional<int> frame;

  struct {
    bool on = false;
    int direction = 1;
    double since = 0, from = 0;  // time in s, and frame, at which playing began
    AtEnd at_end = AtEnd::Loop;
    double speed = 1;
    // The drawing rate while the clip plays. counted_since: time at which the count of drawn frames began, s; pictures:
    // number of frames drawn since that time; pictures_per_second: measured drawing rate, 0 if drawing is fast enough.
    double counted_since = 0, pictures_per_second = 0;
    int pictures = 0;
  } play;

  bool auto_key = false;
  std::string constraint;  // name of the constraint that is unfolded in the panel, and that operators change
  // The poses made by hand, and what they are before constraints are applied (constrained_pose.h); null: no such poses.
  std::shared_ptr<HandPoses> by_hand;
  struct {  // the onion skin: `count` ghosts before and after the shown frame, `step` frames apart
    bool on = false;
    int count = 3, step = 10;
    std::shared_ptr<OnionOutlines> outlines;  // the ghosts' cached outlines; null: nothing is cached yet
  } onion;
  struct {  // the motion paths, which are the lines along which the tips of the selected bones move
    bool on = false;
    std::shared_ptr<MotionPaths> kept;  // the computed points of the paths; null: no point is computed yet
  } paths;
  bool seconds = false;       // true: the ruler counts seconds instead of frames
  std::set<int> chosen;       // frames of the selected keys
  std::map<int, int> moving;  // while keys are dragged: shown frame of each selected key, by its stored frame
  std::optional<Rect> box;    // the selection rectangle that the user draws around keys
  struct {                    // the curve of the active bone's angle over the shown frames
    const Clip* clip = nullptr;
    int bone = -1, first = 0, step = 1;  // active bone; frame of the first sample; frames between samples
    // For each sample, the angle from rest of the bone (x) and of its parent (y), degrees.
    std::vector<glm::vec2> angles;
  } curve;

  bool shows_graph = false;      // true: the graph editor is shown in place of the markers, the clip and the keys
  std::shared_ptr<Graph> graph;  // state of the graph editor (editor/motion/graph.h); null until it is first shown

  // The frames that the timeline shows: the frame at the ruler's left end (`low`) and the number of frames (`count`).
  struct {
    std::string clip;  // text with the name and frames of the clip to which the shown frames were fitted
    double low = 0, count = 250;
    std::optional<int> followed;  // frame of the play head at the last call of follow_head()
  } window;
  // Rectangles of the ruler, of the rows of markers, clip and keys, and of all these rows together, pixels; empty: not
  // shown.
  Rect ruler, marks, lane, keys, area;

  std::int64_t revision = -1;  // revision of the undo history after the last frame change; -1: no frame change yet
  std::unique_ptr<ClipOnRig> prepared;
  std::unique_ptr<FrameLog> frame_log;  // measured drawing times; null: not measured

  // True: the strips are shown in place of the markers, the clip and the keys. Never true together with shows_graph.
  bool shows_strips = false;
  std::shared_ptr<StripView> strips;  // state of the strips' view (editor/motion/strip_view.h); null until it is shown
};

// ---- The shown clip and frame
const Clip* shown_clip(const Document& document);  // returns nullptr if no clip is shown
int shown_frame(const Context& context);
struct FrameRange {
  int low, high;
};
FrameRange playing_range(const Document& document);
// Returns the smallest range of frames that contains the clip's motion or strips, playing range, keys and markers.
FrameRange all_frames(const Clip& clip);
double frame_rate(const Document& document);
// Returns the shown clip retargeted to the document's rig, which gives the rig's pose at each frame; nullptr without a
// clip or a rig.
const ClipOnRig* clip_on_rig(Context& context);

// ---- Going to another frame
void show_frame(Context& context, int frame);  // previews the frame without an edit
void settle_frame(Context& context);           // commits the previewed frame to the document
void drop_frame(Context& context);             // discards the previewed frame and shows the document's frame
void go_to_frame(Context& context, int frame);

// ---- Playing
void play(Context& context, int direction);
void stop_playing(Context& context);
// The editor calls these two functions once per drawn frame. advance_time(), called before the views are drawn, goes to
// the playing clip's current frame. await_next_frame() asks the editor to wake up when the next frame is due.
void advance_time(Context& context);
void await_next_frame(Context& context);

// ---- Edits

// Returns the pose of the document's clip at the document's frame; the document's own pose when no clip moves the rig.
//   prepared  a cache, may be nullptr: receives the clip retargeted to the rig, which the next call then reuses
std::shared_ptr<const Pose> pose_at_frame(const Document& document, std::unique_ptr<ClipOnRig>* prepared = nullptr);
// Adds the clip to the document, makes it the shown clip and goes to its first frame.
void add_clip(Document& document, Clip clip);
// Changes the shown clip and commits the change as one edit. If there is no clip, first adds a clip without a motion.
// FromClip: takes the document's pose from the changed clip; Stays: keeps the document's pose, with the user's changes.
// When the edit removes frames of the motion or changes the frame rate, the play head keeps its time in seconds. If the
// clip no longer has that time, the play head moves to the nearest frame of the clip.
enum class PoseThen { FromClip, Stays };
void edit_clip(Context& context, const std::string& label, PoseThen pose, const std::function<void(Clip&)>& edit);
// Inserts keys at the document's frame for the bones in which `pose` differs from `before`.
void key_changes(Document& document, const Pose& before, const Pose& pose);

}  // namespace limber::editor
