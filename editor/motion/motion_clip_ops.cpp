// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that rename, delete, trim and resample motion clips, and that set how a clip moves the rig: the joint that
// moves each bone (retarget map), the root motion, and the rest poses of clip and rig.
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/clip_keys.h"
#include "core/motion/clip_speed.h"
#include "core/project/strip_clips.h"
#include "core/study/text.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/screen.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

const FileFilter kMaps{"Retarget maps", {".json"}};

// Opens a dialog that asks for a new name of the shown clip. If another clip has that name, a number is added.
void ask_clip_name(Context& context) {
  context.dialogs->open(make_form({"Rename clip",
                                   "Changes the name of the shown clip.",
                                   "Rename",
                                   {text_of("Name", "The clip's name.", shown_clip(context.document())->name)},
                                   [](const Context&, const std::vector<FormField>& fields) -> std::string {
                                     if (fields[0].text.empty())
                                       throw Error("a clip needs a name", "rename", "type a name");
                                     return "";
                                   },
                                   [](Context& c, const std::vector<FormField>& fields) {
                                     if (!shown_clip(c.document()) || fields[0].text == shown_clip(c.document())->name)
                                       return;
                                     const std::string name = unique_clip_name(c.document().clips, fields[0].text);
                                     edit_clip(c, "Rename clip", PoseThen::Stays,
                                               [&](Clip& clip) { clip.name = name; });
                                   }}));
}

std::string needs_clip(const Context& context) {
  return shown_clip(context.document()) ? "" : "Import a motion first, or insert a key";
}
std::string needs_motion(const Context& context) {
  return shown_clip(context.document()) && shown_clip(context.document())->motion ? "" : "Import a motion first";
}
std::string needs_both(const Context& context) {
  if (const std::string why = needs_motion(context); !why.empty()) return why;
  return context.document().armature ? "" : "Import a rig first";
}

Operator setting(const char* id, const char* label, const char* description,
                 const std::function<void(RetargetSettings&)>& set,
                 const std::function<bool(const RetargetSettings&)>& is) {
  return {id,
          label,
          "",
          "Motion",
          description,
          [label, set](Context& c) {
            RetargetSettings next = shown_clip(c.document())->retarget;
            set(next);
            if (next != shown_clip(c.document())->retarget)
              edit_clip(c, std::string("Retarget: ") + label, PoseThen::FromClip,
                        [&](Clip& clip) { clip.retarget = next; });
          },
          needs_motion,
          [is](const Context& c) { return shown_clip(c.document()) && is(shown_clip(c.document())->retarget); }};
}
Operator travel(const char* id, const char* label, const char* description, Travel which) {
  return setting(
      id, label, description, [which](RetargetSettings& s) { s.travel = which; },
      [which](const RetargetSettings& s) { return s.travel == which; });
}
Operator reference(const char* id, const char* label, const char* description, Reference which) {
  return setting(
      id, label, description, [which](RetargetSettings& s) { s.reference = which; },
      [which](const RetargetSettings& s) { return s.reference == which; });
}

// Returns an operator that sets the kind of rest pose of the clip or of the rig, such as a T-pose. The operator
// discards the rotation offsets between the two rest poses that were read from a retarget map file, because they would
// override the offsets that are computed for the new rest pose.
//   whose  which member of RestStances to set: `source` for the clip, `rig` for the rig
Operator rest(const char* id, const char* label, const char* description, RestStance RestStances::*whose,
              RestStance which) {
  return {id,
          label,
          "",
          "Motion",
          description,
          [=](Context& c) {
            if (shown_clip(c.document())->map.stances.*whose == which) return;
            edit_clip(c, std::string("Rest pose: ") + label, PoseThen::FromClip, [&](Clip& clip) {
              clip.map.stances.*whose = which;
              for (auto& [bone, source] : clip.map.sources) source.rest_offset.reset();
            });
          },
          needs_motion,
          [=](const Context& c) {
            return shown_clip(c.document()) && shown_clip(c.document())->map.stances.*whose == which;
          }};
}

// Opens the sidebar of the Pose workspace and shows its Motion section.
void show_retargeting(Context& context) {
  context.screen->workspace = Workspace::Pose;
  context.screen->arrangement().sidebar = true;
  context.ui->open_sections["Motion"] = true;
  context.ui->wanted_section = "Motion";
}

void map_by_names(Context& context) {
  edit_clip(context, "Match by names", PoseThen::FromClip, [](Clip& clip) { clip.map.sources = {}; });
}

void load_map(Context& context) {
  const bool from_dialog = context.dialogs->shown != nullptr;
  browse(context, {.purpose = "map",
                   .title = "Load a retarget map",
                   .action = "Load",
                   .filters = {kMaps},
                   .chosen = [from_dialog](Context& c, const Path& path) {
                     if (!shown_clip(c.document()) || !shown_clip(c.document())->motion || !c.document().armature)
                       return;
                     const RetargetMap map =
                         read_retarget_map(path, *shown_clip(c.document())->motion, *c.document().armature);
                     edit_clip(c, "Load map " + path.filename().string(), PoseThen::FromClip,
                               [&](Clip& clip) { clip.map = map; });
                     if (from_dialog) open_map(c);
                   }});
}

void save_map(Context& context) {
  const bool from_dialog = context.dialogs->shown != nullptr;
  browse(context, {.purpose = "map",
                   .title = "Save the retarget map",
                   .action = "Save",
                   .kind = FileRequest::Kind::Save,
                   .filters = {kMaps},
                   .name = shown_clip(context.document())->name + "-map",
                   .chosen = [from_dialog](Context& c, const Path& path) {
                     const ClipOnRig* clip = clip_on_rig(c);
                     if (!clip || !clip->retarget()) return;
                     write_retarget_map(clip->retarget()->map(), path);
                     c.messages->ok("Saved " + path.filename().string(), path.parent_path().string());
                     if (from_dialog) open_map(c);
                   }});
}

void delete_shown(Context& context) {
  stop_playing(context);
  Document next = context.document();
  const std::string name = next.shown_clip()->name;
  next.clips.erase(next.clips.begin() + next.clip);
  // Removes the strips that played the deleted clip, so that the pose below is computed without them.
  relink_strips(context.document(), next);
  next.clip = std::max(0, std::min(next.clip, static_cast<int>(next.clips.size()) - 1));
  if (const Clip* clip = next.shown_clip())
    next.frame = std::clamp(next.frame, all_frames(*clip).low, all_frames(*clip).high);
  next.pose = pose_at_frame(next);
  commit(context, "Delete clip " + name, std::move(next));
}

// Deletes the shown clip; asks before if strips play it, because these strips are deleted too.
void delete_clip(Context& context) {
  const auto clip = context.document().clips[static_cast<std::size_t>(context.document().clip)];
  const std::vector<StripUse> uses = strip_uses(context.document(), clip);
  if (uses.empty()) return delete_shown(context);
  stop_playing(context);
  Question question{.title = "Delete " + clip->name + " and its strips?", .icon = icon::kTrash};
  for (const StripUse& use : uses)
    question.lines.push_back(
        std::to_string(use.strips) + (use.strips == 1 ? " strip of " : " strips of ") + use.clip +
        (use.strips == 1 ? " plays this clip and is deleted too." : " play this clip and are deleted too."));
  if (constexpr std::size_t kListed = 3; question.lines.size() > kListed) {
    const std::size_t others = question.lines.size() - kListed + 1;
    question.lines.resize(kListed - 1);
    question.lines.push_back("Strips of " + std::to_string(others) + " other clips are deleted too.");
  }
  question.answers = {{"Cancel", {}}, {"Delete", [clip](Context& c) {
                                         if (shown_clip(c.document()) == clip.get()) delete_shown(c);
                                       }}};
  ask(context, std::move(question));
}

// Trims the shown clip to its playing range. Frames of the motion outside the range are kept but not used; keys and
// markers outside the range are deleted.
void trim(Context& context) {
  edit_clip(context, "Trim clip", PoseThen::FromClip, [](Clip& clip) {
    const int low = clip.range_start, high = std::max(low, clip.range_end);
    if (clip.motion) {
      if (high < clip.start || low > clip.end())
        throw Error("the range lies outside the motion", clip.name, "move the range over the frames to keep");
      const int first = std::clamp(clip.first + low - clip.start, clip.first, clip.last),
                last = std::clamp(clip.first + high - clip.start, first, clip.last);
      clip.start = std::max(low, clip.start);
      clip.first = first;
      clip.last = last;
    }
    delete_clip_keys_outside(clip, low, high);
    std::erase_if(clip.markers, [&](const Marker& marker) { return marker.frame < low || marker.frame > high; });
  });
}

void untrim(Context& context) {
  edit_clip(context, "Undo trim", PoseThen::FromClip, [](Clip& clip) {
    clip.start -= clip.first;
    clip.first = 0;
    clip.last = std::max(0, clip.motion->frame_count - 1);
    clip.range_start = clip.start;
    clip.range_end = clip.end();
  });
}

// Gives the shown clip another frame rate. The play head goes to the frame of the same moment.
void resample_shown(Context& context, double rate) {
  if (!shown_clip(context.document()))
    throw Error("the clip was deleted meanwhile", "resample", "select a clip and open the dialog again");
  settle_frame(context);
  const auto source = context.document().clips[static_cast<std::size_t>(context.document().clip)];
  const double ratio = rate / source->rate;
  const double moment = source->start + std::round((double(context.document().frame) - source->start) * ratio);
  take_in_clip(context, source, context.document().armature, "Resample clip", at_rate(*source, rate), false, moment,
               ratio);
}

void ask_rate(Context& context) {
  context.dialogs->open(make_form(
      {"Resample the clip",
       "Changes the number of frames per second. Motion, keys and markers keep their times.",
       "Resample",
       {number_of("Frame rate", "Frames per second.", shown_clip(context.document())->rate, 1, 1000, "%.6g", "fps")},
       [](const Context& c, const std::vector<FormField>& fields) {
         const Clip* clip = shown_clip(c.document());
         if (!clip)
           throw Error("the clip was deleted meanwhile", "resample", "select a clip and open the dialog again");
         const double ratio = fields[0].value / clip->rate;
         return grouped(clip->range_end - clip->range_start + 1) + " frames become " +
                grouped(static_cast<int>(std::round((clip->range_end - clip->range_start) * ratio)) + 1) + ".";
       },
       [](Context& c, const std::vector<FormField>& fields) { resample_shown(c, fields[0].value); }}));
}

}  // namespace

std::vector<Operator> motion_clip_operators() {
  return {
      {"motion.retarget", "Retarget", icon::kMirror, "Motion",
       "Show the retarget settings: how the clip's joints move the rig's bones.", show_retargeting, needs_both},
      {"motion.map", "Map...", "", "Motion", "Map each bone to the joint of the motion that moves it.", open_map,
       needs_both},
      {"motion.map_by_names", "Match by names", "", "Motion", "Match joints and bones by the meaning of their names.",
       map_by_names, needs_both},
      {"motion.load_map", "Load map...", icon::kOpen, "Motion",
       "Load a retarget map: a file that says which joint of the motion moves each bone.", load_map, needs_both},
      {"motion.save_map", "Save map...", icon::kSave, "Motion",
       "Save a retarget map: a file that says which joint of the motion moves each bone, with the rotation offsets "
       "between them.",
       save_map, needs_both},
      travel("motion.travel_locked", "Locked", "Keep the body at its rest position.", Travel::Locked),
      travel("motion.travel_in_place", "In place",
             "Move the body up and down as in the clip, but not along the ground.", Travel::InPlace),
      travel("motion.travel_free", "Free",
             "Move the body along the ground as in the clip, scaled to the length of the rig's legs.", Travel::Free),
      reference("motion.reference_found", "Most upright",
                "Match the rig's rest pose to the frame of the clip in which the figure stands most upright.",
                Reference::Found),
      reference("motion.reference_rest", "Clip's rest pose", "Match the rig's rest pose to the clip's rest pose.",
                Reference::RestPose),
      reference("motion.reference_first", "Clip's first frame", "Match the rig's rest pose to the clip's first frame.",
                Reference::FirstFrame),
      rest("motion.rest_file", "Clip as stored", "Use the clip's rest pose as the file stores it.",
           &RestStances::source, RestStance::AsItLies),
      rest("motion.rest_t", "Clip in T-pose",
           "Treat the clip's rest pose as arms to the sides and palms down, regardless of its joints' directions.",
           &RestStances::source, RestStance::TPose),
      rest("motion.rest_a", "Clip in A-pose",
           "Treat the clip's rest pose as arms half way down and thumbs forward, regardless of its joints' directions.",
           &RestStances::source, RestStance::APose),
      rest("motion.rest_anatomical", "Clip supine",
           "Treat the clip's rest pose as arms hanging and palms forward, like a body on its back, regardless of its "
           "joints' directions.",
           &RestStances::source, RestStance::Anatomical),
      rest("motion.rig_rest_file", "Rig as stored", "Take the direction of the rig's palms at rest from its fingers.",
           &RestStances::rig, RestStance::AsItLies),
      rest("motion.rig_rest_t", "Rig in T-pose",
           "Treat the rig's palms as facing down at rest; for rigs without fingers.", &RestStances::rig,
           RestStance::TPose),
      rest("motion.rig_rest_a", "Rig in A-pose",
           "Treat the rig's thumbs as pointing forward at rest; for rigs without fingers.", &RestStances::rig,
           RestStance::APose),
      rest("motion.rig_rest_anatomical", "Rig supine",
           "Treat the rig's palms as facing forward at rest; for rigs without fingers.", &RestStances::rig,
           RestStance::Anatomical),
      setting(
          "motion.mirror", "Mirror", "Swap left and right: the rig's left side moves as the clip's right side.",
          [](RetargetSettings& s) { s.mirror = !s.mirror; }, [](const RetargetSettings& s) { return s.mirror; }),
      {"motion.rename_clip", "Rename clip...", icon::kRename, "Motion", "Rename the shown clip.", ask_clip_name,
       needs_clip},
      {"motion.delete_clip", "Delete clip", icon::kTrash, "Motion", "Delete the shown clip from the project.",
       delete_clip, needs_clip},
      {"motion.trim", "Trim to range", "", "Motion",
       "Remove frames, keys and markers outside the playing range. Undo trim restores the frames.", trim, needs_clip},
      {"motion.untrim", "Undo trim", "", "Motion", "Restore the frames of the motion that Trim to range removed.",
       untrim, needs_motion},
      {"motion.resample", "Resample clip...", "", "Motion", "Change the clip's number of frames per second.", ask_rate,
       needs_clip},
  };
}

}  // namespace limber::editor
