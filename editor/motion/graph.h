// SPDX-License-Identifier: AGPL-3.0-or-later
// The graph editor: shows the shown clip as curves, in place of the timeline's rows. A track is a selected bone's
// rotation, or the translation of the whole body (its shift). If no bone is selected, all bones with keys have tracks.
// A track has three channels: the angles about X, Y and Z in degrees (core/motion/euler_channels.h), or the shift along
// X, Y and Z in mm. A key of a bone is one rotation, so its three channels have keys at the same frames.
//
// The time axis is the same as in the timeline. Curves are sampled at whole frames, once for each change of the clip
// or its keys. The poses of the recorded motion are sampled for a few milliseconds in each drawn frame, until all are
// known.
#pragma once

#include <array>
#include <compare>

#include "core/project/document.h"
#include "editor/context/layout.h"
#include "editor/motion/timeline.h"

namespace limber::editor {

struct Context;

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
enum class KeySide { In, Out };  // the side of a key in time: In is before the key, Out after it

// The curves of one track.
struct GraphCurve {
  int bone = -1;
  // Keys of a bone's rotation, by frame; empty if the track is the body's translation.
  std::map<int, glm::dquat> rotations;
  std::map<int, glm::dvec3> places;  // keys of the body's translation, by frame, mm; empty if the track is a rotation
  // The differences between the keys and the recorded motion, by frame: rotations (`turns`) or translations in mm
  // (`shifts`). The curve interpolates these corrections and adds them to the motion. Without a motion, they equal the
  // keys.
  std::map<int, glm::dquat> turns;
  std::map<int, glm::dvec3> shifts;
  KeyShapes shapes;
  // `values` is the curve of the motion with its keys, `motion` the curve of the recorded motion alone (empty: there is
  // no motion). Both lists have one element for each frame: the values of the three channels, degrees or mm.
  std::vector<glm::dvec3> values, motion;
};

struct GraphCurves {
  std::shared_ptr<const Clip> clip;     // the clip whose motion is sampled
  std::shared_ptr<const Armature> rig;  // the rig whose poses are sampled; null: nothing is sampled
  bool has_motion = false;
  FrameRange range{0, -1};
  // The poses of the motion that are sampled so far, from the first frame of `range`. Copies of GraphCurves share
  // them.
  std::shared_ptr<std::vector<Pose>> motion = std::make_shared<std::vector<Pose>>();
  std::map<GraphTrack, GraphCurve> tracks;

  bool complete() const { return !has_motion || std::ssize(*motion) == range.high - range.low + 1; }
};

struct Graph {
  std::set<GraphChannel> hidden;
  // Tracks of the body's translation that have been listed before; a new one is hidden at first.
  std::set<GraphTrack> met_shifts;
  std::set<GraphKey> chosen;
  double low = -10, high = 10;  // the values at the plot's lower and upper edge
  // Text that identifies the clip and tracks to which `low` and `high` were fitted.
  std::string fitted;
  // While keys are dragged: all keys, with the dragged keys at their new frames and values; empty: no drag.
  std::optional<Keys> preview;
  std::shared_ptr<const Clip> previewed;  // the clip whose keys `preview` replaces
  // chosen_of_clips: for each clip before and after an edit, the keys that were selected in it, so that undo and redo
  // can select these keys again. met_clip: the clip to which the keys in `chosen` belong.
  std::vector<std::pair<std::weak_ptr<const Clip>, std::set<GraphKey>>> chosen_of_clips;
  std::weak_ptr<const Clip> met_clip;
  std::optional<Rect> box;  // the rectangle that the user draws around keys
  // For each workspace, the height of the bottom area before the graph editor enlarged it; 0: not enlarged.
  std::array<float, std::tuple_size_v<Arrangements>> heights_before{};
  Rect plot;  // the area in which the curves are drawn, pixels
  GraphCurves curves;
};

Graph& graph_of(Context& context);  // returns the state of the graph editor; creates it if there is none
// Returns the clip's keys, or their preview during a drag; needs a shown clip.
const Keys& graph_keys(const Context& context);
bool graph_is_shown(const Context& context);
std::shared_ptr<const Clip> graph_clip(const Document& document);  // returns the shown clip; null if there is no clip
// Stores which keys are selected in a clip, for undo.
void remember_chosen(Graph& graph, const std::shared_ptr<const Clip>& clip, const std::set<GraphKey>& chosen);

// ---- Tracks and curves
struct GraphTracks {
  std::vector<GraphTrack> tracks;
  int left_out = 0;  // number of bones that are left out because too many are selected
};
GraphTracks graph_tracks(const Context& context);
std::set<int> key_frames_of(const Keys& keys, const GraphTrack& track);
bool is_shown(const Graph& graph, const GraphChannel& channel);
// Returns true if the key exists and its channel is shown.
bool exists(const Graph& graph, const Keys& keys, const GraphKey& key);

// Updates the curves for changes of the clip, its keys or the rig. Needs a shown clip and a rig.
void update_curves(Context& context);
// Returns the values of the three channels at a frame, which may be fractional. Of the equivalent angles of a rotation,
// returns those nearest to the angles at the whole frame before it.
glm::dvec3 graph_values(const GraphCurves& curves, const GraphTrack& track, double frame);

// Returns the slopes of the three channels on one side of a key, in degrees or mm per frame. If the clip has a recorded
// motion, these are the slopes of the keys' correction of the motion. So a horizontal handle leaves the motion's own
// curve unchanged, even if that curve is noisy. Returns nothing if there is no Bezier span on that side.
std::optional<glm::dvec3> graph_speeds(const GraphCurves& curves, const GraphTrack& track, int frame, KeySide side);
// Returns the tangent of a key that gives the channels these slopes.
glm::dvec3 tangent_of_speeds(const GraphCurves& curves, const GraphTrack& track, int frame, const glm::dvec3& speeds);
// Returns the number of frames from a key to the end of its handle, which is a third of the frames to the next key on
// that side. Returns nothing if there is no Bezier span on that side.
std::optional<double> handle_frames(const GraphCurves& curves, const GraphTrack& track, int frame, KeySide side);

// ---- What the graph editor shows
void show_graph(Context& context, bool on);
// Fits the value axis to the keys; nullptr: to all shown curves.
void fit_graph_values(Context& context, const std::set<GraphKey>* keys = nullptr);
float graph_y(const Graph& graph, double value);
double graph_value_at(const Graph& graph, float y);
// Returns the selected keys that exist and are shown.
std::set<GraphKey> chosen_graph_keys(const Context& context);
bool any_graph_key_chosen(const Context& context);

}  // namespace limber::editor
