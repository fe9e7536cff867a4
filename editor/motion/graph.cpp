// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/graph.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/motion/euler_channels.h"
#include "core/motion/key_curve.h"
#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// If more bones than this are selected, only the curves of the first kMostBones bones are shown.
constexpr std::size_t kMostBones = 12;
constexpr int kMostFrames = 20'000;            // largest number of frames shown; a longer clip shows its first frames
constexpr std::chrono::milliseconds kTime{6};  // time limit per drawn frame for sampling the motion's poses
// When the graph editor is shown, the area below the views gets this height, pixels at scale 1.
constexpr float kHeight = 300;
constexpr double kRoom = 0.12;  // margin above and below the curves, as a fraction of their height

glm::dquat motion_rotation(const GraphCurves& curves, int bone, double frame) {
  if (!curves.has_motion || curves.motion->empty()) return {1, 0, 0, 0};
  const double place = std::clamp(frame - curves.range.low, 0.0, static_cast<double>(curves.motion->size() - 1));
  const auto before = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(before);
  const glm::dquat& q = (*curves.motion)[before].rotation[bone];
  return share == 0 ? q : glm::normalize(glm::slerp(q, (*curves.motion)[before + 1].rotation[bone], share));
}
glm::dvec3 motion_shift(const GraphCurves& curves, double frame) {
  if (!curves.has_motion || curves.motion->empty()) return glm::dvec3(0);
  const double place = std::clamp(frame - curves.range.low, 0.0, static_cast<double>(curves.motion->size() - 1));
  const auto before = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(before);
  const glm::dvec3& p = (*curves.motion)[before].root_translation;
  return share == 0 ? p : glm::mix(p, (*curves.motion)[before + 1].root_translation, share);
}

glm::dvec3 angles_near(const glm::dquat& q, const glm::dvec3& degrees) {
  return glm::degrees(channel_angles(q, glm::radians(degrees)));
}

// Returns the key at a frame; nullptr if there is none.
template <class Value>
const Value* key_at(const std::map<int, Value>& keys, double frame) {
  const auto found = keys.find(static_cast<int>(std::floor(frame)));
  return found != keys.end() && found->first == frame ? &found->second : nullptr;
}

// Returns the values of the curve at a frame, in degrees or mm. Of the equivalent angles of a rotation, it returns
// those nearest to `near`. At a key's frame it returns the key's own values, which are known even where the motion is
// not sampled.
glm::dvec3 values_near(const GraphCurves& curves, const GraphTrack& track, const GraphCurve& curve, double frame,
                       const glm::dvec3& near) {
  if (track.is_shift) {
    if (const glm::dvec3* shift = key_at(curve.places, frame)) return *shift;
    const glm::dvec3 base = motion_shift(curves, frame);
    return curve.shifts.empty() ? base : value_at(curve.shifts, curve.shapes, frame) + base;
  }
  if (const glm::dquat* rotation = key_at(curve.rotations, frame)) return angles_near(*rotation, near);
  const glm::dquat base = motion_rotation(curves, curve.bone, frame);
  return angles_near(curve.turns.empty() ? base : value_at(curve.turns, curve.shapes, frame) * base, near);
}

// Adds the curve's values at the frames for which the motion has been sampled since the last call.
void extend(const GraphCurves& curves, const GraphTrack& track, GraphCurve& curve) {
  const auto known = static_cast<std::size_t>(curves.has_motion ? std::ssize(*curves.motion)
                                                                : curves.range.high - curves.range.low + 1);
  while (curve.values.size() < known) {
    const int frame = curves.range.low + static_cast<int>(curve.values.size());
    const glm::dvec3 near = curve.values.empty() ? glm::dvec3(0) : curve.values.back();
    curve.values.push_back(values_near(curves, track, curve, frame, near));
  }
  while (curves.has_motion && curve.motion.size() < known) {
    const int frame = curves.range.low + static_cast<int>(curve.motion.size());
    const glm::dvec3 near = curve.motion.empty() ? glm::dvec3(0) : curve.motion.back();
    curve.motion.push_back(track.is_shift ? motion_shift(curves, frame)
                                          : angles_near(motion_rotation(curves, curve.bone, frame), near));
  }
}

// Returns the smallest range that contains the clip's motion, playing range and markers, and the keys `keys`. These
// replace the clip's own keys. The function runs in every drawn frame, so it reads only the first and last key of each
// track.
FrameRange range_of(const Clip& clip, const Keys& keys) {
  Clip without = {.motion = clip.motion, .start = clip.start, .first = clip.first, .last = clip.last};
  without.range_start = clip.range_start;
  without.range_end = clip.range_end;
  without.markers = clip.markers;
  without.strips = clip.strips;
  without.rate = clip.rate;
  FrameRange range = all_frames(without);
  const auto take = [&](const auto& track) {
    if (track.empty()) return;
    range.low = std::min(range.low, track.begin()->first);
    range.high = std::max(range.high, track.rbegin()->first);
  };
  for (const auto& [bone, track] : keys.bones) take(track);
  take(keys.root);
  return range;
}

bool same_motion(const Clip& a, const Clip& b) {
  return a.motion == b.motion && a.strips == b.strips && a.start == b.start && a.first == b.first && a.last == b.last &&
         a.map == b.map && a.retarget == b.retarget;
}

// If another clip is shown than in the last call, as after undo or redo, selects the keys that were last selected in
// this clip.
void meet_clip(Graph& graph, const std::shared_ptr<const Clip>& clip) {
  if (graph.met_clip.lock() == clip) return;
  graph.met_clip = clip;
  for (const auto& [known, chosen] : graph.chosen_of_clips)
    if (known.lock() == clip) graph.chosen = chosen;
}

// Returns the sampled poses of `curves` whose frames lie in `range`, one for each frame from the first frame of
// `range`. If that first frame is not sampled, the list is empty.
std::shared_ptr<std::vector<Pose>> known_motion(const GraphCurves& curves, const FrameRange& range) {
  if (range.low < curves.range.low) return std::make_shared<std::vector<Pose>>();
  const auto wanted = static_cast<std::size_t>(range.high - range.low + 1);
  if (range.low == curves.range.low && curves.motion->size() <= wanted) return curves.motion;
  const auto size = std::ssize(*curves.motion);
  const auto first = curves.motion->begin() + std::min<std::ptrdiff_t>(range.low - curves.range.low, size);
  const auto count = std::min<std::ptrdiff_t>(std::ssize(*curves.motion) - (first - curves.motion->begin()),
                                              static_cast<std::ptrdiff_t>(wanted));
  return std::make_shared<std::vector<Pose>>(first, first + count);
}

// Discards the curves if the clip's motion, the rig or the range of frames has changed. Keeps the sampled poses that
// are still valid.
void meet_motion(Context& context, GraphCurves& curves, const ClipOnRig& on_rig) {
  FrameRange range = range_of(*on_rig.clip(), graph_keys(context));
  const bool same = curves.clip && curves.rig == on_rig.armature() && same_motion(*curves.clip, *on_rig.clip());
  // While keys are dragged, the range keeps its first frame and never shrinks. Otherwise each step of the drag could
  // discard the sampled poses.
  if (same && graph_of(context).preview) range = {curves.range.low, std::max(range.high, curves.range.high)};
  range.high = std::min(range.high, range.low + kMostFrames - 1);
  if (same && curves.range.low == range.low && curves.range.high == range.high) return;
  std::shared_ptr<std::vector<Pose>> known = same ? known_motion(curves, range) : std::make_shared<std::vector<Pose>>();
  curves = {on_rig.clip(), on_rig.armature(), on_rig.has_base(), range, std::move(known), {}};
}

void sample_motion(Ui& ui, GraphCurves& curves, const ClipOnRig& on_rig) {
  const auto began = std::chrono::steady_clock::now();
  while (!curves.complete() && std::chrono::steady_clock::now() - began < kTime)
    curves.motion->push_back(on_rig.base_at(curves.range.low + static_cast<int>(curves.motion->size())));
  if (!curves.complete()) ui.touch();
}

// Returns the motion's pose at a frame. Uses the sampled pose if there is one, because retargeting a frame takes long.
Pose motion_pose(const GraphCurves& curves, const ClipOnRig& on_rig, int frame) {
  const std::int64_t place = std::int64_t{frame} - curves.range.low;
  return place >= 0 && place < std::ssize(*curves.motion) ? (*curves.motion)[static_cast<std::size_t>(place)]
                                                          : on_rig.base_at(frame);
}

// Returns the track's curve, with its keys and their corrections: the differences between the keys and the motion.
GraphCurve keyed(const GraphCurves& curves, const ClipOnRig& on_rig, const Keys& keys, const GraphTrack& track) {
  GraphCurve curve;
  curve.bone = on_rig.armature()->find(track.bone).value_or(-1);
  if (track.is_shift) {
    curve.places = curve.shifts = keys.root;
    curve.shapes = keys.root_shapes;
    if (on_rig.has_base())
      for (auto& [frame, shift] : curve.shifts) shift -= motion_pose(curves, on_rig, frame).root_translation;
    return curve;
  }
  if (const auto found = keys.bones.find(track.bone); found != keys.bones.end())
    curve.rotations = curve.turns = found->second;
  curve.shapes = shapes_of(keys, track.bone);
  if (on_rig.has_base())
    for (auto& [frame, turn] : curve.turns)
      turn = glm::normalize(turn * glm::conjugate(motion_pose(curves, on_rig, frame).rotation[curve.bone]));
  return curve;
}

bool is_of(const GraphCurve& curve, const Keys& keys, const GraphTrack& track) {
  if (track.is_shift) return curve.places == keys.root && curve.shapes == keys.root_shapes;
  const auto found = keys.bones.find(track.bone);
  return (found == keys.bones.end() ? curve.rotations.empty() : curve.rotations == found->second) &&
         curve.shapes == shapes_of(keys, track.bone);
}

template <class Value>
bool has_span(const std::map<int, Value>& keys, const KeyShapes& shapes, int frame, KeySide side) {
  const auto key = keys.find(frame);
  if (key == keys.end()) return false;
  if (side == KeySide::Out)
    return std::next(key) != keys.end() && shape_at(shapes, frame).next == Interpolation::Bezier;
  return key != keys.begin() && shape_at(shapes, std::prev(key)->first).next == Interpolation::Bezier;
}

template <class Value>
double span_frames(const std::map<int, Value>& keys, int frame, KeySide side) {
  const auto key = keys.find(frame);
  return side == KeySide::Out ? std::next(key)->first - frame : frame - std::prev(key)->first;
}

}  // namespace

Graph& graph_of(Context& context) {
  if (!context.timeline->graph) context.timeline->graph = std::make_shared<Graph>();
  return *context.timeline->graph;
}

const Keys& graph_keys(const Context& context) {
  const auto& graph = context.timeline->graph;
  const Clip* clip = shown_clip(context.document());
  return graph && graph->preview && graph->previewed.get() == clip ? *graph->preview : clip->keys;
}

bool graph_is_shown(const Context& context) {
  return context.timeline->shows_graph && context.screen->arrangement().timeline &&
         !context.screen->arrangement().console;
}

std::shared_ptr<const Clip> graph_clip(const Document& document) {
  return document.clips.empty() ? nullptr : document.clips[static_cast<std::size_t>(document.clip)];
}

void remember_chosen(Graph& graph, const std::shared_ptr<const Clip>& clip, const std::set<GraphKey>& chosen) {
  std::erase_if(graph.chosen_of_clips,
                [&](const auto& one) { return one.first.expired() || one.first.lock() == clip; });
  graph.chosen_of_clips.emplace_back(clip, chosen);
  graph.met_clip = clip;
}

GraphTracks graph_tracks(const Context& context) {
  GraphTracks found;
  const auto& rig = context.document().armature;
  const Clip* clip = shown_clip(context.document());
  if (!rig || !clip) return found;
  std::size_t bones = 0;
  bool shift_listed = false;
  for (int bone = 0; bone < std::ssize(rig->bones); ++bone) {
    const Bone& b = rig->bones[bone];
    const bool wanted =
        context.selection->bones.empty() ? clip->keys.bones.contains(b.name) : context.selection->bones.contains(bone);
    if (!wanted) continue;
    if (++bones > kMostBones) {
      ++found.left_out;
      continue;
    }
    found.tracks.push_back({b.name, false});
    // The whole body has a single translation (shift), even if the rig has several root bones. Its track is listed only
    // at the first root bone.
    if (b.parent < 0 && !std::exchange(shift_listed, true)) found.tracks.push_back({b.name, true});
  }
  return found;
}

std::set<int> key_frames_of(const Keys& keys, const GraphTrack& track) {
  std::set<int> frames;
  if (track.is_shift)
    for (const auto& [frame, shift] : keys.root) frames.insert(frame);
  else if (const auto found = keys.bones.find(track.bone); found != keys.bones.end())
    for (const auto& [frame, rotation] : found->second) frames.insert(frame);
  return frames;
}

bool exists(const Graph& graph, const Keys& keys, const GraphKey& key) {
  if (!is_shown(graph, key.channel)) return false;
  if (key.channel.track.is_shift) return keys.root.contains(key.frame);
  const auto bone = keys.bones.find(key.channel.track.bone);
  return bone != keys.bones.end() && bone->second.contains(key.frame);
}

bool is_shown(const Graph& graph, const GraphChannel& channel) {
  return graph.curves.tracks.contains(channel.track) && !graph.hidden.contains(channel);
}

void update_curves(Context& context) {
  GraphCurves& curves = graph_of(context).curves;
  const ClipOnRig* on_rig = clip_on_rig(context);
  if (!on_rig) return;
  meet_clip(graph_of(context), on_rig->clip());
  meet_motion(context, curves, *on_rig);
  sample_motion(context.ui, curves, *on_rig);
  const Keys& keys = graph_keys(context);
  std::map<GraphTrack, GraphCurve> tracks;
  for (const GraphTrack& track : graph_tracks(context).tracks) {
    // A walk moves the body by several metres, and curves of angles on the same scale would look flat. So the curves of
    // the body's translation are hidden until the user shows them.
    if (track.is_shift && graph_of(context).met_shifts.insert(track).second)
      for (int axis = 0; axis < 3; ++axis) graph_of(context).hidden.insert({track, axis});
    const auto before = curves.tracks.find(track);
    const bool same = before != curves.tracks.end() && is_of(before->second, keys, track);
    GraphCurve curve = same ? std::move(before->second) : keyed(curves, *on_rig, keys, track);
    if (!same && before != curves.tracks.end()) curve.motion = std::move(before->second.motion);
    extend(curves, track, curve);
    tracks.emplace(track, std::move(curve));
  }
  curves.tracks = std::move(tracks);
}

glm::dvec3 graph_values(const GraphCurves& curves, const GraphTrack& track, double frame) {
  const GraphCurve& curve = curves.tracks.at(track);
  const auto place = static_cast<std::ptrdiff_t>(std::floor(frame)) - curves.range.low;
  if (curve.values.empty()) return values_near(curves, track, curve, frame, glm::dvec3(0));
  const glm::dvec3& sampled =
      curve.values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(place, 0, std::ssize(curve.values) - 1))];
  if (frame == std::floor(frame) && place >= 0 && place < std::ssize(curve.values)) return sampled;
  return values_near(curves, track, curve, frame, sampled);
}

std::optional<glm::dvec3> graph_speeds(const GraphCurves& curves, const GraphTrack& track, int frame, KeySide side) {
  const GraphCurve& curve = curves.tracks.at(track);
  const auto on = [side](const Tangents& tangents) { return side == KeySide::In ? tangents.in : tangents.out; };
  if (track.is_shift)
    return has_span(curve.shifts, curve.shapes, frame, side)
               ? std::optional(on(tangents_at(curve.shifts, curve.shapes, frame)))
               : std::nullopt;
  if (!has_span(curve.turns, curve.shapes, frame, side)) return std::nullopt;
  return glm::degrees(channel_speeds(glm::radians(graph_values(curves, track, frame)),
                                     on(tangents_at(curve.turns, curve.shapes, frame))));
}

glm::dvec3 tangent_of_speeds(const GraphCurves& curves, const GraphTrack& track, int frame, const glm::dvec3& speeds) {
  if (track.is_shift) return speeds;
  return velocity_of_channels(glm::radians(graph_values(curves, track, frame)), glm::radians(speeds));
}

std::optional<double> handle_frames(const GraphCurves& curves, const GraphTrack& track, int frame, KeySide side) {
  const GraphCurve& curve = curves.tracks.at(track);
  const auto frames = [&](const auto& keys) {
    return has_span(keys, curve.shapes, frame, side) ? std::optional(span_frames(keys, frame, side) / 3) : std::nullopt;
  };
  return track.is_shift ? frames(curve.shifts) : frames(curve.turns);
}

void show_graph(Context& context, bool on) {
  Graph& graph = graph_of(context);
  context.timeline->shows_graph = on;
  if (on) {
    context.timeline->shows_strips = false;
    Arrangement& arrangement = context.screen->arrangement();
    arrangement.timeline = true;
    arrangement.console = false;
    // Deselects the keys in the timeline's rows: the graph hides these rows, and hidden keys must not be changed.
    context.timeline->chosen.clear();
    graph.fitted.clear();
    if (arrangement.bottom_height < kHeight)
      graph.heights_before[static_cast<std::size_t>(context.workspace())] =
          std::exchange(arrangement.bottom_height, kHeight);
  } else {
    for (std::size_t i = 0; i < context.screen->arrangements.size(); ++i) {
      const float before = std::exchange(graph.heights_before[i], 0.0f);
      float& height = context.screen->arrangements[i].bottom_height;
      // Restores the height of the area below the views, unless the user has changed it while the graph was shown.
      if (before > 0 && height == kHeight) height = before;
    }
  }
  context.ui->touch();
}

void fit_graph_values(Context& context, const std::set<GraphKey>* keys) {
  Graph& graph = graph_of(context);
  double low = INFINITY, high = -INFINITY;
  const auto take = [&](double value) { low = std::min(low, value), high = std::max(high, value); };
  if (keys)
    for (const GraphKey& key : *keys) take(graph_values(graph.curves, key.channel.track, key.frame)[key.channel.axis]);
  else
    for (const auto& [track, curve] : graph.curves.tracks)
      for (int axis = 0; axis < 3; ++axis)
        if (is_shown(graph, {track, axis}))
          for (const auto* values : {&curve.values, &curve.motion})
            for (const glm::dvec3& value : *values) take(value[axis]);
  if (low > high) low = high = 0;
  // For very large values, 1 is below the precision of doubles. The last term keeps `low` and `high` distinct.
  const double room = std::max({1.0, kRoom * (high - low), 1e-6 * std::max(std::abs(low), std::abs(high))});
  graph.low = low - room;
  graph.high = high + room;
  context.ui->touch();
}

float graph_y(const Graph& graph, double value) {
  const double share = (value - graph.low) / (graph.high - graph.low);
  return graph.plot.high.y - static_cast<float>(share * graph.plot.height());
}

double graph_value_at(const Graph& graph, float y) {
  return graph.low + (graph.high - graph.low) * (graph.plot.high.y - y) / std::max(1.0f, graph.plot.height());
}

std::set<GraphKey> chosen_graph_keys(const Context& context) {
  std::set<GraphKey> found;
  const auto& graph = context.timeline->graph;
  if (!graph || !context.timeline->shows_graph || !shown_clip(context.document())) return found;
  const Keys& keys = graph_keys(context);
  for (const GraphKey& key : graph->chosen)
    if (exists(*graph, keys, key)) found.insert(found.end(), key);
  return found;
}

bool any_graph_key_chosen(const Context& context) {
  const auto& graph = context.timeline->graph;
  if (!graph || !context.timeline->shows_graph || !shown_clip(context.document())) return false;
  return std::any_of(graph->chosen.begin(), graph->chosen.end(),
                     [&, &keys = graph_keys(context)](const GraphKey& key) { return exists(*graph, keys, key); });
}

}  // namespace limber::editor
