// SPDX-License-Identifier: AGPL-3.0-or-later
// Time in the editor. The document's frame and pose belong together: the pose is what the clip says at that frame,
// until the user changes it. Going to another frame takes the pose from the clip again and is one edit, in which all
// steps of one way through time are put together: undo goes back to where it began, with the pose that was there.
//
// While the pointer drags the play head, and while the clip plays, the frame is only shown (views' preview_pose); it is
// taken into the document when the play head rests. A playing clip shows the frame of the moment, however long the last
// picture took: frames are dropped, time is not.
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
#include "editor/context/editor.h"
#include "editor/context/frame_timing.h"

namespace limber::editor {

enum class AtEnd { Stop, Loop, PingPong };

struct OnionOutlines;

struct Timeline {
  // The frame that is shown in place of the document's, while it is scrubbed or plays.
  std::optional<int> frame;

  struct {
    bool on = false;
    int direction = 1;
    double since = 0, from = 0;  // when, and at which frame, it began
    AtEnd at_end = AtEnd::Loop;
    double speed = 1;
    // Pictures of the last second, when they are fewer than the clip's frames and the window could show.
    double counted_since = 0, pictures_per_second = 0;
    int pictures = 0;
  } play;

  bool auto_key = false;
  struct {  // ghosts on either side, so many frames apart
    bool on = false;
    int count = 3, step = 10;
    std::shared_ptr<OnionOutlines> outlines;  // editor/motion/onion_skin_overlay.h; null before there are any
  } onion;
  bool seconds = false;       // the ruler's numbers
  std::set<int> chosen;       // frames of keys
  std::map<int, int> moving;  // where chosen keys are shown while they are dragged
  std::optional<Rect> box;    // that chooses keys
  struct {                    // the chosen bone's angle and its parent's, over what is seen of the clip
    const Clip* clip = nullptr;
    int bone = -1, first = 0, step = 1;  // frames
    std::vector<glm::vec2> angles;       // degrees
  } curve;

  // What of time is seen: the frame at the left end of the ruler, and how many fit.
  struct {
    std::string clip;  // for which it was fitted
    double low = 0, count = 250;
    std::optional<int> followed;  // the frame at which the play head was when it came into sight last
  } window;
  Rect ruler, marks, lane, keys, area;  // where these stood in the last picture; empty while the timeline is not shown

  std::int64_t revision = -1;  // of the step that the last change of frame made
  std::unique_ptr<ClipOnRig> prepared;
  std::unique_ptr<FrameLog> frame_log;  // null: nobody asks what frames cost
};

// ---- what is shown
const Clip* shown_clip(const Editor& editor);  // nullptr where there is none
int shown_frame(const Editor& editor);
struct FrameRange {
  int low, high;
};
FrameRange playing_range(const Editor& editor);
// Where the clip has something: its motion, what plays, keys, markers.
FrameRange all_frames(const Clip& clip);
double frame_rate(const Editor& editor);
// The clip prepared for the rig; nullptr without either.
const ClipOnRig* clip_on_rig(Editor& editor);

// ---- going to a frame
void show_frame(Editor& editor, int frame);  // at once, for now
void settle_frame(Editor& editor);           // what is shown becomes the document's
void drop_frame(Editor& editor);             // back to the document's
void go_to_frame(Editor& editor, int frame);

// ---- playing
void play(Editor& editor, int direction);
void stop_playing(Editor& editor);
// Once a frame, before the views are drawn, and after them: the moment at which the next frame is due.
void advance_time(Editor& editor);
void await_next_frame(Editor& editor);

// ---- edits
// The document's pose as its clip says at its frame; as it is where no clip moves the rig.
//   prepared  in which the preparation is kept for the next time
std::shared_ptr<const Pose> pose_at_frame(const Document& document, std::unique_ptr<ClipOnRig>* prepared = nullptr);
// The clip becomes the shown one, at its first frame.
void add_clip(Document& document, Clip clip);
// One edit of the shown clip. Where there is no clip, one without a motion is made. The pose is taken from it anew, or,
// where the edit says nothing of it, stays with what the user changed. Where frames of the motion go, or get another
// rate, the play head stays at its moment, or goes to the nearest that is left.
enum class PoseThen { FromClip, Stays };
void edit_clip(Editor& editor, const std::string& label, PoseThen pose, const std::function<void(Clip&)>& edit);
// The document with what `pose` changes set as keys at its frame.
void key_changes(Document& document, const Pose& before, const Pose& pose);

}  // namespace limber::editor
