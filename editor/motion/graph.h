// SPDX-License-Identifier: AGPL-3.0-or-later
// The graph editor: the timeline's second face, which shows the shown clip as curves. A track is a selected bone's
// rotation, or the body's shift; where no bone is selected, the bones with keys are shown. A track has three channels:
// the angles about X, Y and Z in degrees (core/motion/euler_channels.h), or the shift along them in mm. A key of a
// bone is one rotation, so its three channels have keys at the same frames.
//
// The time axis is the timeline's. Curves are sampled at whole frames, once for each change of the clip or its keys;
// the motion's own poses are sampled a few milliseconds' worth per drawn frame, until all are known.
#pragma once

#include <array>
#include <compare>

#include "editor/motion/timeline.h"

namespace limber::editor {

struct GraphTrack {
  std::string bone;
  bool is_shift = false;

  auto operator<=>(const GraphTrack&) const = default;
};
struct GraphChannel {
  GraphTrack track;
  int axis = 0;

  auto operator<=>(const GraphChannel&) const = default;
};
struct GraphKey {
  GraphChannel channel;
  int frame = 0;

  auto operator<=>(const GraphKey&) const = default;
};
enum class KeySide { In, Out };  // before or after a key

// The curves of one track.
struct GraphCurve {
  int bone = -1;
  std::map<int, glm::dquat> rotations;  // the keys, of a bone
  std::map<int, glm::dvec3> places;     // or of the shift
  // The corrections of the motion at the keys, which the keys' curve interpolates; without a motion the keys
  // themselves.
  std::map<int, glm::dquat> turns;
  std::map<int, glm::dvec3> shifts;
  KeyShapes shapes;
  std::vector<glm::dvec3> values, motion;  // one per frame, degrees or mm; `motion` without the keys, empty: none
};

struct GraphCurves {
  std::shared_ptr<const Clip> clip;     // whose motion is sampled
  std::shared_ptr<const Armature> rig;  // null: nothing is sampled
  bool has_motion = false;
  FrameRange range{0, -1};
  // The motion's poses at the range's frames, as far as they are sampled. Copies of the curves share them.
  std::shared_ptr<std::vector<Pose>> motion = std::make_shared<std::vector<Pose>>();
  std::map<GraphTrack, GraphCurve> tracks;

  bool complete() const { return !has_motion || std::ssize(*motion) == range.high - range.low + 1; }
};

struct Graph {
  std::set<GraphChannel> hidden;
  std::set<GraphTrack> met_shifts;  // shifts that were listed before
  std::set<GraphKey> chosen;
  double low = -10, high = 10;            // the values at the plot's lower and upper edge
  std::string fitted;                     // names what the values were fitted to
  std::optional<Keys> preview;            // the keys while they are dragged
  std::shared_ptr<const Clip> previewed;  // the clip whose keys `preview` replaces
  // The keys that were selected when a change of a clip began, and when it ended, so that undo and redo select them
  // again; and the clip whose selection is shown.
  std::vector<std::pair<std::weak_ptr<const Clip>, std::set<GraphKey>>> chosen_of_clips;
  std::weak_ptr<const Clip> met_clip;
  std::optional<Rect> box;  // the rectangle that the user draws around keys
  // For each workspace, the height of the bottom area before it was made higher for the graph; 0: it was not.
  std::array<float, std::tuple_size_v<Arrangements>> heights_before{};
  Rect plot;  // where curves are drawn
  GraphCurves curves;
};

Graph& graph_of(Editor& editor);               // creates the state if there is none
const Keys& graph_keys(const Editor& editor);  // the keys as they are shown; the clip exists
bool graph_is_shown(const Editor& editor);
std::shared_ptr<const Clip> graph_clip(const Editor& editor);  // the shown clip; null: none
// Stores which keys are selected in a clip, for undo.
void remember_chosen(Graph& graph, const std::shared_ptr<const Clip>& clip, const std::set<GraphKey>& chosen);

// ---- Tracks and curves
struct GraphTracks {
  std::vector<GraphTrack> tracks;
  int left_out = 0;  // bones beyond the most that are shown
};
GraphTracks graph_tracks(const Editor& editor);
std::set<int> key_frames_of(const Keys& keys, const GraphTrack& track);
bool is_shown(const Graph& graph, const GraphChannel& channel);
bool exists(const Graph& graph, const Keys& keys, const GraphKey& key);  // whether it is a key of a shown channel

// Samples what has changed since the last call. Needs a shown clip and a rig.
void update_curves(Editor& editor);
// Returns the three values at a frame, which may lie between whole frames, near those of the whole frame before it.
glm::dvec3 graph_values(const GraphCurves& curves, const GraphTrack& track, double frame);

// Returns the speeds of the three values at a key, per frame, before or after it. Over a motion these are the speeds of
// the correction, so that level handles keep the motion's own course, however it trembles. Returns nothing where no
// Bezier span is on that side.
std::optional<glm::dvec3> graph_speeds(const GraphCurves& curves, const GraphTrack& track, int frame, KeySide side);
// Returns the tangent of a key's shape that gives the values these speeds.
glm::dvec3 tangent_of_speeds(const GraphCurves& curves, const GraphTrack& track, int frame, const glm::dvec3& speeds);
// Returns the number of frames from a key to the end of its handle, a third of the span; nothing where no Bezier span
// is on that side.
std::optional<double> handle_frames(const GraphCurves& curves, const GraphTrack& track, int frame, KeySide side);

// ---- The view
void show_graph(Editor& editor, bool on);
void fit_graph_values(Editor& editor, const std::set<GraphKey>* keys = nullptr);  // nullptr: to all shown curves
float graph_y(const Graph& graph, double value);
double graph_value_at(const Graph& graph, float y);
// Returns the selected keys that exist and are shown.
std::set<GraphKey> chosen_graph_keys(const Editor& editor);
bool any_graph_key_chosen(const Editor& editor);

}  // namespace limber::editor
