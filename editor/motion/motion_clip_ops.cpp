// SPDX-License-Identifier: AGPL-3.0-or-later
// Clips: how they move the rig, and what is made of them.
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/motion_edit.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator_polls.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

const FileFilter kMaps{"Maps", {".json"}};

// A name that no other clip has.
void ask_clip_name(Editor& editor) {
  editor.open_dialog(make_form({"Rename clip",
                                "Another name for the shown clip.",
                                "Rename",
                                {text_of("Name", "The clip's name.", shown_clip(editor)->name)},
                                [](const Editor&, const std::vector<FormField>& fields) -> std::string {
                                  if (fields[0].text.empty()) throw Error("a clip needs a name", "rename", "type one");
                                  return "";
                                },
                                [](Editor& e, const std::vector<FormField>& fields) {
                                  if (!shown_clip(e) || fields[0].text == shown_clip(e)->name) return;
                                  const std::string name = unique_clip_name(e.document().clips, fields[0].text);
                                  edit_clip(e, "Rename clip", PoseThen::Stays, [&](Clip& clip) { clip.name = name; });
                                }}));
}

std::string needs_clip(const Editor& editor) {
  return shown_clip(editor) ? "" : "Import a motion first, or insert a key";
}
std::string needs_motion(const Editor& editor) {
  return shown_clip(editor) && shown_clip(editor)->motion ? "" : "Import a motion first";
}
std::string needs_both(const Editor& editor) {
  if (const std::string why = needs_motion(editor); !why.empty()) return why;
  return editor.document().armature ? "" : "Import a rig first";
}

Operator setting(const char* id, const char* label, const char* description,
                 const std::function<void(RetargetSettings&)>& set,
                 const std::function<bool(const RetargetSettings&)>& is) {
  return {id,
          label,
          "",
          "Motion",
          description,
          [label, set](Editor& e) {
            RetargetSettings next = shown_clip(e)->retarget;
            set(next);
            if (next != shown_clip(e)->retarget)
              edit_clip(e, std::string("Retarget: ") + label, PoseThen::FromClip,
                        [&](Clip& clip) { clip.retarget = next; });
          },
          needs_motion,
          [is](const Editor& e) { return shown_clip(e) && is(shown_clip(e)->retarget); }};
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

// Offsets that were read from a file give way to what is said.
Operator rest(const char* id, const char* label, const char* description, RestStance RestStances::*whose,
              RestStance which) {
  return {id,
          label,
          "",
          "Motion",
          description,
          [=](Editor& e) {
            if (shown_clip(e)->map.stances.*whose == which) return;
            edit_clip(e, std::string("At rest: ") + label, PoseThen::FromClip, [&](Clip& clip) {
              clip.map.stances.*whose = which;
              for (auto& [bone, source] : clip.map.sources) source.rest_offset.reset();
            });
          },
          needs_motion,
          [=](const Editor& e) { return shown_clip(e) && shown_clip(e)->map.stances.*whose == which; }};
}

// Into sight; where the sidebar is closed it opens.
void show_retargeting(Editor& editor) {
  editor.workspace = Workspace::Pose;
  editor.arrangement().sidebar = true;
  editor.open_sections["Motion"] = true;
  editor.wanted_section = "Motion";
}

void map_by_names(Editor& editor) {
  edit_clip(editor, "Match by names", PoseThen::FromClip, [](Clip& clip) { clip.map.sources = {}; });
}

void load_map(Editor& editor) {
  const bool from_dialog = editor.dialog != nullptr;
  browse(editor, {.purpose = "map",
                  .title = "Load a map",
                  .action = "Load",
                  .filters = {kMaps},
                  .chosen = [from_dialog](Editor& e, const Path& path) {
                    if (!shown_clip(e) || !shown_clip(e)->motion || !e.document().armature) return;
                    const RetargetMap map = read_retarget_map(path, *shown_clip(e)->motion, *e.document().armature);
                    edit_clip(e, "Load map " + path.filename().string(), PoseThen::FromClip,
                              [&](Clip& clip) { clip.map = map; });
                    if (from_dialog) open_map(e);
                  }});
}

void save_map(Editor& editor) {
  const bool from_dialog = editor.dialog != nullptr;
  browse(editor, {.purpose = "map",
                  .title = "Save the map",
                  .action = "Save",
                  .kind = FileRequest::Kind::Save,
                  .filters = {kMaps},
                  .name = shown_clip(editor)->name + "-map",
                  .chosen = [from_dialog](Editor& e, const Path& path) {
                    const ClipOnRig* clip = clip_on_rig(e);
                    if (!clip || !clip->retarget()) return;
                    write_retarget_map(clip->retarget()->map(), path);
                    e.messages.ok("Saved " + path.filename().string(), path.parent_path().string());
                    if (from_dialog) open_map(e);
                  }});
}

void delete_clip(Editor& editor) {
  stop_playing(editor);
  Document next = editor.document();
  const std::string name = next.shown_clip()->name;
  next.clips.erase(next.clips.begin() + next.clip);
  next.clip = std::max(0, std::min(next.clip, static_cast<int>(next.clips.size()) - 1));
  if (const Clip* clip = next.shown_clip())
    next.frame = std::clamp(next.frame, all_frames(*clip).low, all_frames(*clip).high);
  next.pose = pose_at_frame(next);
  commit(editor, "Delete clip " + name, std::move(next));
}

// What plays becomes all there is of the motion; keys and markers outside go.
void trim(Editor& editor) {
  edit_clip(editor, "Trim clip", PoseThen::FromClip, [](Clip& clip) {
    const int low = clip.range_start, high = std::max(low, clip.range_end);
    if (clip.motion) {
      if (high < clip.start || low > clip.end())
        throw Error("the range lies outside the motion", clip.name, "move it over the frames that shall stay");
      const int first = std::clamp(clip.first + low - clip.start, clip.first, clip.last),
                last = std::clamp(clip.first + high - clip.start, first, clip.last);
      clip.start = std::max(low, clip.start);
      clip.first = first;
      clip.last = last;
    }
    std::set<int> outside;
    for (int frame : frames_of(clip.keys))
      if (frame < low || frame > high) outside.insert(frame);
    delete_keys(clip.keys, outside);
    std::erase_if(clip.markers, [&](const Marker& marker) { return marker.frame < low || marker.frame > high; });
  });
}

void untrim(Editor& editor) {
  edit_clip(editor, "Whole motion", PoseThen::FromClip, [](Clip& clip) {
    clip.start -= clip.first;
    clip.first = 0;
    clip.last = std::max(0, clip.motion->frame_count - 1);
    clip.range_start = clip.start;
    clip.range_end = clip.end();
  });
}

// Everything that stands at a frame goes with the moment that it meant.
void change_rate(Clip& clip, double rate) {
  const double ratio = rate / clip.rate;
  const auto moved = [&](int frame) { return clip.start + static_cast<int>(std::round((frame - clip.start) * ratio)); };
  std::map<int, int> frame_of;
  for (int frame : frames_of(clip.keys)) frame_of[frame] = moved(frame);
  move_keys(clip.keys, frame_of);
  for (Marker& marker : clip.markers) marker.frame = moved(marker.frame);
  clip.range_start = moved(clip.range_start);
  clip.range_end = moved(clip.range_end);
  if (clip.motion) {
    Motion played = *clip.motion;
    played.frame_time = 1 / clip.rate;
    clip.motion = std::make_shared<const Motion>(resampled(played, rate));
    const int most = std::max(0, clip.motion->frame_count - 1);
    clip.first = std::clamp(static_cast<int>(std::round(clip.first * ratio)), 0, most);
    clip.last = std::clamp(static_cast<int>(std::round(clip.last * ratio)), clip.first, most);
  }
  clip.rate = rate;
}

void ask_rate(Editor& editor) {
  editor.open_dialog(make_form(
      {"Resample the clip",
       "The same motion with another number of frames in a second; keys and markers keep their moments.",
       "Resample",
       {number_of("Frame rate", "Frames in a second.", shown_clip(editor)->rate, 1, 1000, "%.6g", "fps")},
       [](const Editor& e, const std::vector<FormField>& fields) {
         const Clip* clip = shown_clip(e);
         if (!clip) throw Error("there is no clip any more", "resample", "open this again");
         const double ratio = fields[0].value / clip->rate;
         return std::to_string(clip->range_end - clip->range_start + 1) + " frames become " +
                std::to_string(static_cast<int>(std::round((clip->range_end - clip->range_start) * ratio)) + 1) + ".";
       },
       [](Editor& e, const std::vector<FormField>& fields) {
         edit_clip(e, "Resample clip", PoseThen::FromClip, [&](Clip& clip) { change_rate(clip, fields[0].value); });
       }}));
}

}  // namespace

std::vector<Operator> motion_clip_operators() {
  return {
      {"motion.retarget", "Retarget", icon::kMirror, "Motion", "Shows how the clip moves the rig.", show_retargeting,
       needs_both},
      {"motion.map", "Map...", "", "Motion", "Which joint of the motion moves which bone.", open_map, needs_both},
      {"motion.map_by_names", "By names", "", "Motion", "Matches joints and bones by what their names mean.",
       map_by_names, needs_both},
      {"motion.load_map", "Load map...", icon::kOpen, "Motion",
       "Takes the map of a file, as the command line's --map does.", load_map, needs_both},
      {"motion.save_map", "Save map...", icon::kSave, "Motion",
       "Writes the map into a file, with the offsets that are in use.", save_map, needs_both},
      travel("motion.travel_locked", "Locked", "The body stays where it rests.", Travel::Locked),
      travel("motion.travel_in_place", "In place", "The body goes up and down, and walks on the spot.",
             Travel::InPlace),
      travel("motion.travel_free", "Free", "The body travels as the source does, as far as its own legs carry it.",
             Travel::Free),
      reference("motion.reference_found", "Most upright",
                "The source stands as the rig rests where it stands most upright.", Reference::Found),
      reference("motion.reference_rest", "Its rest pose", "The source stands as the rig rests in the file's rest pose.",
                Reference::RestPose),
      reference("motion.reference_first", "Its first frame", "The source stands as the rig rests in its first frame.",
                Reference::FirstFrame),
      rest("motion.rest_file", "Take as it lies",
           "The clip's rest pose is what its joints show: bones take their directions.", &RestStances::source,
           RestStance::AsItLies),
      rest("motion.rest_t", "Take in T-pose",
           "At rest the actor stands with arms to the sides and palms down, however the file lays the joints.",
           &RestStances::source, RestStance::TPose),
      rest("motion.rest_a", "Take in A-pose",
           "At rest the actor stands with arms half way down and thumbs forward, however the file lays the joints.",
           &RestStances::source, RestStance::APose),
      rest("motion.rest_anatomical", "Take supine",
           "At rest the actor's arms hang and the palms face forward, as of a body on its back, however the file lays "
           "the joints.",
           &RestStances::source, RestStance::Anatomical),
      rest("motion.rig_rest_file", "Rig as it lies", "Where the rig's palms face at rest is what its fingers show.",
           &RestStances::rig, RestStance::AsItLies),
      rest("motion.rig_rest_t", "Rig in T-pose", "The rig rests with its palms down; of use where it has no fingers.",
           &RestStances::rig, RestStance::TPose),
      rest("motion.rig_rest_a", "Rig in A-pose",
           "The rig rests with its thumbs forward; of use where it has no fingers.", &RestStances::rig,
           RestStance::APose),
      rest("motion.rig_rest_anatomical", "Rig supine",
           "The rig rests with its palms forward; of use where it has no fingers.", &RestStances::rig,
           RestStance::Anatomical),
      setting(
          "motion.mirror", "Mirror", "The left side does what the right side of the source does.",
          [](RetargetSettings& s) { s.mirror = !s.mirror; }, [](const RetargetSettings& s) { return s.mirror; }),
      {"motion.rename_clip", "Rename clip...", icon::kRename, "Motion", "Gives the shown clip another name.",
       ask_clip_name, needs_clip},
      {"motion.delete_clip", "Delete clip", icon::kTrash, "Motion", "Takes the shown clip out of the project.",
       delete_clip, needs_clip},
      {"motion.trim", "Trim to range", "", "Motion",
       "Only the range stays of the clip; the whole motion can be brought back.", trim, needs_clip},
      {"motion.untrim", "Whole motion", "", "Motion", "Brings back what was trimmed.", untrim, needs_motion},
      {"motion.resample", "Resample clip...", "", "Motion", "Another number of frames in a second.", ask_rate,
       needs_clip},
  };
}

}  // namespace limber::editor
