// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that select what the timeline shows (rows, graph or strips), and operators of strips and their tracks.
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/recorded_clip.h"
#include "core/study/text.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator.h"
#include "editor/context/selection.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/graph.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/strip_tool.h"
#include "editor/motion/timeline_faces.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr std::int64_t kMostFrames = 1e6;  // strips that play more frames than this are not baked into a motion

// ---- Why operators cannot run

std::string needs_clip(const Context& context) {
  return shown_clip(context.document()) ? "" : "Import a motion first, or insert a key";
}
std::string needs_shown_strips(const Context& context) {
  if (const std::string why = needs_clip(context); !why.empty()) return why;
  if (!shown_strips(context)) return "Make strips of the clip first";
  return strips_are_shown(context) ? "" : "Show the strips first";
}
std::string needs_chosen(const Context& context) {
  if (const std::string why = needs_shown_strips(context); !why.empty()) return why;
  return chosen_strips(context).empty() ? "Select strips first" : "";
}
std::string needs_active(const Context& context) {
  if (const std::string why = needs_shown_strips(context); !why.empty()) return why;
  return active_strip(context) ? "" : "Select a strip first";
}
std::string needs_active_and_rig(const Context& context) {
  if (const std::string why = needs_active(context); !why.empty()) return why;
  return context.document().armature ? "" : "Import a rig first";
}
std::string needs_track(const Context& context) {
  if (const std::string why = needs_shown_strips(context); !why.empty()) return why;
  return active_track(context) ? "" : "Add a track first";
}
std::string needs_strips_and_rig(const Context& context) {
  if (const std::string why = needs_clip(context); !why.empty()) return why;
  if (!shown_clip(context.document())->strips) return "Make strips of the clip first";
  return context.document().armature ? "" : "Import a rig first";
}
std::string needs_clip_of_strips(const Context& context) {
  if (!needs_clip(context).empty()) return needs_clip(context);
  const auto& clips = context.document().clips;
  const bool any = std::any_of(clips.begin(), clips.end(), [](const auto& clip) { return !clip->strips; });
  return any ? "" : "Import a motion first: strips play other clips";
}

// ---- Adding strips of clips

std::string track_name_of(const Strips& strips) {
  return unique_track_name(strips, "Track " + std::to_string(strips.tracks.size() + 1));
}

// Adds a clip with a strip of the shown clip to the document, and shows it. Returns the strip's name.
std::string make_strips_in(Document& next) {
  const std::shared_ptr<const Clip> source = next.clips[static_cast<std::size_t>(next.clip)];
  Clip clip{.name = unique_clip_name(next.clips, source->name + " strips"), .rate = source->rate};
  clip.range_start = source->range_start;
  clip.range_end = source->range_end;
  Strips strips;
  strips.tracks.push_back({.name = track_name_of(strips), .strips = {strip_of(source, strips, source->range_start)}});
  const std::string name = strips.tracks[0].strips[0].name;
  clip.strips = std::make_shared<const Strips>(std::move(strips));
  next.clips.push_back(std::make_shared<const Clip>(std::move(clip)));
  next.clip = static_cast<int>(next.clips.size()) - 1;
  return name;
}

// Adds a clip with a strip of the shown clip, and shows it.
void make_strips(Context& context) {
  stop_playing(context);
  settle_frame(context);
  Document next = context.document();
  const std::string source = next.shown_clip()->name, name = make_strips_in(next);
  next.pose = pose_at_frame(next, &context.timeline->prepared);
  commit(context, "Make strips of " + source, std::move(next));
  show_strips(context, true);
  choose_strip(context, name);
}

// Returns the index of the lowest track from `from` upwards that has room for the strip. If there is none, adds a track
// and returns its index.
std::size_t track_for(Strips& strips, const Strip& strip, std::size_t from, double rate) {
  for (std::size_t t = from; t < strips.tracks.size(); ++t)
    if (has_room(strips.tracks[t], strip.start, std::max(strip.start + 1, end_of(strip, rate)), rate)) return t;
  strips.tracks.push_back({.name = track_name_of(strips)});
  return strips.tracks.size() - 1;
}

// Adds a strip of the clip at the frame, and returns the strip's name. On the lowest track, the strip holds its last
// pose after its end. If that track has an earlier strip and the rig has one root bone, the new strip begins at the
// position and heading that the body has at that frame. A strip on a higher track holds no pose after its end.
//   from  index of the lowest track on which the strip may lie
std::string add_strip_to(Strips& strips, const std::shared_ptr<const Clip>& source, int frame, std::size_t from,
                         const std::shared_ptr<const Armature>& armature, double rate) {
  const auto roots = armature ? std::count_if(armature->bones.begin(), armature->bones.end(),
                                              [](const Bone& bone) { return bone.parent < 0; })
                              : 0;
  Strip strip = strip_of(source, strips, frame);
  const std::string name = strip.name;
  const std::size_t t = track_for(strips, strip, from, rate);
  strip.holds = t == 0;
  const bool follows = t == 0 && !strips.tracks[t].strips.empty() && strips.tracks[t].strips.front().start < frame;
  insert_strip(strips.tracks[t], std::move(strip));
  if (!follows || roots != 1) return name;
  const StripPlace place = *find_strip(strips, name);
  strips.tracks[place.track].strips[place.index].place = place_where_body_is(strips, place, armature, rate);
  return name;
}

// Makes strips of the shown clip and adds another strip to them, as one edit.
void make_strips_with(Context& context, const std::shared_ptr<const Clip>& source, int frame) {
  stop_playing(context);
  settle_frame(context);
  Document next = context.document();
  make_strips_in(next);
  auto& shown = next.clips[static_cast<std::size_t>(next.clip)];
  Clip clip = *shown;
  Strips strips = *clip.strips;
  const std::string name = add_strip_to(strips, source, frame, 0, next.armature, clip.rate);
  require_within_limits(strips);
  const StripSpan span = *span_of(strips, clip.rate);
  clip.range_start = span.first;
  clip.range_end = span.last;
  clip.strips = std::make_shared<const Strips>(std::move(strips));
  shown = std::make_shared<const Clip>(std::move(clip));
  next.pose = pose_at_frame(next, &context.timeline->prepared);
  commit(context, "Add strip of " + source->name, std::move(next));
  show_strips(context, true);
  choose_strip(context, name);
}

void add_strip(Context& context, const std::shared_ptr<const Clip>& source, int frame) {
  if (!shown_strips(context)) return make_strips_with(context, source, frame);
  show_strips(context, true);
  std::string name;
  const std::size_t from = active_track(context).value_or(0);
  const double rate = strips_rate(context.document());
  change_strips(context, "Add strip of " + source->name, [&](Strips& strips) {
    name = add_strip_to(strips, source, frame, from, context.document().armature, rate);
  });
  choose_strip(context, name);
}

void ask_strip(Context& context) {
  const bool has_strips = shown_strips(context) != nullptr;
  std::vector<std::shared_ptr<const Clip>> sources;
  std::vector<std::string> names;
  for (const auto& clip : context.document().clips)
    if (!clip->strips) sources.push_back(clip), names.push_back(clip->name);
  context.dialogs->open(make_form(
      {"Add strip",
       "Adds a strip that plays a clip. The strip is put on the active track, or on a track above it if there is no "
       "room.",
       "Add",
       {choice_of("Clip", "The clip that the strip plays.", names),
        number_of("Start", "The frame at which the strip begins.", shown_frame(context), -100'000, 1e6, "%.0f")},
       [=](const Context& c, const std::vector<FormField>& fields) {
         if (!shown_clip(c.document()) || (has_strips && !shown_strips(c)))
           throw Error("the strips were deleted meanwhile", "strip", "open the dialog again");
         const Clip& clip = *sources[static_cast<std::size_t>(fields[0].chosen)];
         const int frames = std::max(clip.range_start, clip.range_end) - clip.range_start + 1;
         return grouped(frames) + (frames == 1 ? " frame." : " frames of the clip.") +
                (shown_strips(c) ? "" : " A new clip plays " + shown_clip(c.document())->name + " as a strip, too.");
       },
       [=](Context& c, const std::vector<FormField>& fields) {
         const auto& source = sources[static_cast<std::size_t>(fields[0].chosen)];
         const auto& clips = c.document().clips;
         if (!shown_clip(c.document()) || (has_strips && !shown_strips(c)) ||
             std::find(clips.begin(), clips.end(), source) == clips.end())
           throw Error("the clip was deleted meanwhile", source->name, "open the dialog again");
         add_strip(c, source, static_cast<int>(std::lround(fields[1].value)));
       }}));
}

void bake_strips(Context& context) {
  stop_playing(context);
  const auto source = graph_clip(context.document());
  const auto [first, last] = playing_range(context.document());
  if (std::int64_t{last} - first >= kMostFrames)
    throw Error("the strips play too many frames", "frames " + std::to_string(first) + " to " + std::to_string(last),
                "set a shorter range");
  start_task(context, "Bake strips to clip", [source, rig = context.document().armature](Progress& progress) -> Finish {
    auto baked = std::make_shared<Clip>(baked_clip(source, rig, progress));
    baked->name += " baked";
    return [=](Context& c) {
      take_in_clip(c, source, rig, "Bake strips to clip", *baked, true);
      show_face(c, TimelineFace::Rows);
      c.messages->ok(grouped(baked->motion->frame_count) + " frames baked",
                     "The clip " + shown_clip(c.document())->name + " contains the combined motion of the strips");
    };
  });
}

// ---- Strips

void choose_all(Context& context) {
  for (const StripTrack& track : shown_strips(context)->tracks)
    for (const Strip& strip : track.strips) strip_view(context.timeline).chosen.insert(strip.name);
}

void delete_chosen(Context& context) {
  const std::set<std::string> chosen = chosen_strips(context);
  change_strips(context, chosen.size() == 1 ? "Delete strip" : "Delete strips", [&](Strips& strips) {
    for (StripTrack& track : strips.tracks)
      std::erase_if(track.strips, [&](const Strip& strip) { return chosen.contains(strip.name); });
  });
}

void mute_chosen(Context& context) {
  const std::set<std::string> chosen = chosen_strips(context);
  bool any_plays = false;
  for (const std::string& name : chosen) {
    const StripPlace place = *find_strip(*shown_strips(context), name);
    any_plays = any_plays || !shown_strips(context)->tracks[place.track].strips[place.index].muted;
  }
  change_strips(context, any_plays ? "Mute strips" : "Unmute strips", [&](Strips& strips) {
    for (StripTrack& track : strips.tracks)
      for (Strip& strip : track.strips)
        if (chosen.contains(strip.name)) strip.muted = any_plays;
  });
}

// Splits at the shown frame the selected strips or, if none is selected, all strips that play there.
void split_at_head(Context& context) {
  const int frame = shown_frame(context);
  const double rate = strips_rate(context.document());
  std::set<std::string> wanted = chosen_strips(context), seconds;
  if (wanted.empty())
    for (const StripTrack& track : shown_strips(context)->tracks)
      for (const Strip& strip : track.strips) wanted.insert(strip.name);
  Strips next = *shown_clip(context.document())->strips;
  for (const std::string& name : wanted) {
    const StripPlace place = *find_strip(next, name);
    StripTrack& track = next.tracks[place.track];
    const Strip strip = track.strips[place.index];
    if (frame <= strip.start || frame >= end_of(strip, rate)) continue;
    auto [left, right] = split(strip, frame, rate, unique_strip_name(next, name));
    seconds.insert(right.name);
    track.strips[place.index] = std::move(left);
    insert_strip(track, std::move(right));
  }
  if (seconds.empty())
    throw Error("no selected strip plays before and after this frame", "frame " + std::to_string(frame),
                "move the play head to the middle of a strip");
  change_strips(context, "Split strips", [&](Strips& strips) { strips = std::move(next); });
  strip_view(context.timeline).chosen = seconds;
  strip_view(context.timeline).active = *seconds.begin();
}

void set_bones(Context& context, bool all) {
  std::optional<std::set<std::string>> bones;
  if (!all) {
    const Armature& armature = *context.document().armature;
    bones.emplace();
    std::vector<char> inside(armature.bones.size());
    for (const int bone : context.selection->bones) inside[static_cast<std::size_t>(bone)] = 1;
    for (std::size_t bone = 0; bone < armature.bones.size(); ++bone) {
      const int parent = armature.bones[bone].parent;
      if (parent >= 0 && inside[static_cast<std::size_t>(parent)]) inside[bone] = 1;
      if (inside[bone]) bones->insert(armature.bones[bone].name);
    }
  }
  change_active_strip(context, "Set bones of strip", [&](Strip& strip) { strip.bones = bones; });
}
std::string needs_bones(const Context& context) {
  if (const std::string why = needs_active_and_rig(context); !why.empty()) return why;
  const auto count = std::ssize(context.document().armature->bones);
  const bool fits = std::all_of(context.selection->bones.begin(), context.selection->bones.end(),
                                [&](int bone) { return bone >= 0 && bone < count; });
  return fits && !context.selection->bones.empty() ? "" : "Select bones first";
}

void begin_where_body_is(Context& context) {
  const auto armature = context.document().armature;
  const double rate = strips_rate(context.document());
  const std::string name = active_strip(context)->name;
  change_strips(context, "Begin strip where the body is", [&](Strips& strips) {
    const StripPlace place = *find_strip(strips, name);
    strips.tracks[place.track].strips[place.index].place = place_where_body_is(strips, place, armature, rate);
  });
}

// ---- Edits of tracks

void change_track(Context& context, const std::string& label, const std::function<void(StripTrack&)>& edit) {
  const std::size_t track = *active_track(context);
  change_strips(context, label, [&](Strips& strips) { edit(strips.tracks[track]); });
}

void add_track(Context& context) {
  if (!shown_strips(context)) make_strips(context);
  show_strips(context, true);
  if (shown_strips(context)->tracks.size() >= kMostTracks)
    throw Error("no more tracks can be added", std::to_string(kMostTracks) + " tracks", "delete a track first");
  const std::string name = track_name_of(*shown_strips(context));
  change_strips(context, "Add track", [&](Strips& strips) { strips.tracks.push_back({.name = name}); });
  strip_view(context.timeline).track = name;
}

void move_track(Context& context, int by) {
  const std::size_t track = *active_track(context), to = track + static_cast<std::size_t>(by);
  const std::string name = shown_strips(context)->tracks[track].name;
  if (to >= shown_strips(context)->tracks.size())
    return context.messages->info(name + (by > 0 ? " is the highest track" : " is the lowest track"));
  change_strips(context, by > 0 ? "Move track up" : "Move track down",
                [&](Strips& strips) { std::swap(strips.tracks[track], strips.tracks[to]); });
  strip_view(context.timeline).track = name;
}

void delete_track(Context& context) {
  const std::size_t track = *active_track(context);
  change_strips(context, "Delete track", [&](Strips& strips) {
    strips.tracks.erase(strips.tracks.begin() + static_cast<std::ptrdiff_t>(track));
  });
}

void ask_track_name(Context& context) {
  const std::string before = shown_strips(context)->tracks[*active_track(context)].name;
  context.dialogs->open(make_form({"Rename track",
                                   "Changes the name of the active track.",
                                   "Rename",
                                   {text_of("Name", "The track's name.", before)},
                                   [](const Context&, const std::vector<FormField>& fields) -> std::string {
                                     if (fields[0].text.empty())
                                       throw Error("a track needs a name", "rename", "type a name");
                                     return "";
                                   },
                                   [before](Context& c, const std::vector<FormField>& fields) {
                                     const std::string& name = fields[0].text;
                                     const auto track = active_track(c);
                                     if (!track)
                                       throw Error("the track was deleted meanwhile", before, "open the dialog again");
                                     if (name == before) return;
                                     change_track(c, "Rename track", [&](StripTrack& one) {
                                       one.name = unique_track_name(*shown_clip(c.document())->strips, name);
                                     });
                                     strip_view(c.timeline).track = shown_strips(c)->tracks[*track].name;
                                   }}));
}

bool is_track(const Context& context, bool StripTrack::*flag) {
  const auto track = active_track(context);
  return track && shown_strips(context)->tracks[*track].*flag;
}

std::vector<Operator> track_operators() {
  return {
      {"strips.add_track", "Add strip track", icon::kAdd, "Motion", "Add an empty track above the others.", add_track,
       needs_clip_of_strips},
      {"strips.rename_track", "Rename strip track...", icon::kRename, "Motion", "Rename the active track.",
       ask_track_name, needs_track},
      {"strips.track_up", "Move strip track up", "", "Motion",
       "Move the active track up by one, so that it plays over the track that was above it.",
       [](Context& c) { move_track(c, 1); }, needs_track},
      {"strips.track_down", "Move strip track down", "", "Motion",
       "Move the active track down by one, so that the track that was below it plays over it.",
       [](Context& c) { move_track(c, -1); }, needs_track},
      {"strips.mute_track", "Mute strip track", "", "Motion", "Switch the active track's strips off, or on again.",
       [](Context& c) { change_track(c, "Mute track", [](StripTrack& track) { track.muted = !track.muted; }); },
       needs_track, [](const Context& c) { return is_track(c, &StripTrack::muted); }},
      {"strips.solo_track", "Solo strip track", "", "Motion",
       "Play only the active track and other tracks with solo switched on.",
       [](Context& c) { change_track(c, "Solo track", [](StripTrack& track) { track.solo = !track.solo; }); },
       needs_track, [](const Context& c) { return is_track(c, &StripTrack::solo); }},
      {"strips.delete_track", "Delete strip track", icon::kTrash, "Motion", "Delete the active track with its strips.",
       delete_track, needs_track},
  };
}

}  // namespace

std::vector<Operator> strip_operators() {
  std::vector<Operator> all{
      {"motion.next_face", "Next timeline view", "", "Motion",
       "Switch the timeline to its next view: keys, curves or strips.",
       [](Context& c) { show_face(c, static_cast<TimelineFace>((static_cast<int>(shown_face(c.timeline)) + 1) % 3)); },
       needs_clip},
      {"motion.show_rows", "Timeline rows", "", "Motion", "Show the markers, the clip and the keys in the timeline.",
       [](Context& c) { show_face(c, TimelineFace::Rows); }, needs_clip,
       [](const Context& c) { return shown_face(c.timeline) == TimelineFace::Rows; }},
      {"strips.show", "Strips", "", "Motion",
       "Show the clip's strips instead of the timeline's rows. Run again to show the rows.",
       [](Context& c) { show_face(c, strips_are_shown(c) ? TimelineFace::Rows : TimelineFace::Strips); }, needs_clip,
       strips_are_shown},
      {"strips.make", "Make strips of the clip", "", "Motion",
       "Add a clip that plays the shown clip as a strip. You can then add strips of other clips.", make_strips,
       [](const Context& c) {
         if (const std::string why = needs_clip(c); !why.empty()) return why;
         return shown_clip(c.document())->strips ? std::string("This clip is made of strips already") : std::string();
       }},
      {"strips.add", "Add strip...", icon::kAdd, "Motion", "Add a strip of another clip at the play head.", ask_strip,
       needs_clip_of_strips},
      {"strips.select", "Select and drag strips", "", "Motion",
       "Select strips, or drag them or their ends. Drag in an empty area to select strips with a box.", press_strips,
       needs_shown_strips},
      {"strips.select_all", "Select all strips", "", "Motion", "Select every strip of the clip.", choose_all,
       needs_shown_strips},
      {"strips.select_none", "Deselect strips", "", "Motion", "Deselect all strips.",
       [](Context& c) { strip_view(c.timeline).chosen.clear(), strip_view(c.timeline).active.clear(); }, needs_chosen},
      {"strips.pan", "Pan the strips", "", "Motion", "Drag to scroll the strips.", pan_strips, needs_shown_strips},
      {"strips.move", "Move strips", icon::kMove, "Motion",
       "Move the selected strips in time with the pointer, or by a typed number of frames.", begin_moving_strips,
       needs_chosen},
      {"strips.duplicate", "Duplicate strips", icon::kDuplicate, "Motion",
       "Copy the selected strips and move the copies with the pointer.", begin_duplicating_strips, needs_chosen},
      {"strips.split", "Split strips", icon::kCut, "Motion",
       "Split the selected strips at the play head, or all strips there if none is selected.", split_at_head,
       needs_shown_strips},
      {"strips.mute", "Mute strips", "", "Motion", "Switch the selected strips off, or on again.", mute_chosen,
       needs_chosen},
      {"strips.delete", "Delete strips", icon::kTrash, "Motion", "Delete the selected strips. Their clips stay.",
       delete_chosen, needs_chosen},
      {"strips.bones_selected", "Strip on selected bones", "", "Motion",
       "Let the active strip move only the selected bones and their descendants.",
       [](Context& c) { set_bones(c, false); }, needs_bones},
      {"strips.bones_all", "Strip on all bones", "", "Motion", "Let the active strip move every bone.",
       [](Context& c) { set_bones(c, true); }, needs_active},
      {"strips.begin_here", "Begin strip where the body is", "", "Motion",
       "Move and turn the active strip along the ground so that it begins where the body is at that frame.",
       begin_where_body_is, needs_active_and_rig},
      {"strips.clear_place", "Begin strip at clip's position", "", "Motion",
       "Begin the active strip at the position and heading that its clip has.",
       [](Context& c) {
         change_active_strip(c, "Begin strip at clip's position", [](Strip& strip) { strip.place = {}; });
       },
       needs_active},
      {"strips.bake", "Bake strips to clip", "", "Motion",
       "Add a clip that contains the combined motion of all strips.", bake_strips, needs_strips_and_rig},
  };
  for (Operator& op : track_operators()) all.push_back(std::move(op));
  return all;
}

}  // namespace limber::editor
