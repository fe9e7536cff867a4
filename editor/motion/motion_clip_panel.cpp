// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel of the Pose workspace that selects the shown clip and sets how the clip moves the rig: the joint that moves
// each bone, the root motion, and the rest poses of clip and rig.
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

// Draws a field that selects one of several operators, of which exactly one is checked.
//   words  short texts of the choices; empty: the operators' labels are the texts
void choice_of_operators(Context& context, const Rect& rect, const char* name, std::initializer_list<const char*> ids,
                         std::initializer_list<const char*> words = {}) {
  std::vector<std::string> labels;
  int chosen = 0;
  for (const char* id : ids) {
    const Operator* op = find_operator(context.operators, id);
    if (op->checked(context)) chosen = static_cast<int>(labels.size());
    labels.push_back(words.size() > 0 ? words.begin()[labels.size()] : op->label);
  }
  const PathScope path(context.ui, name);
  if (choice_field(context.ui, rect, labels, chosen)) run(context, ids.begin()[chosen]);
}

constexpr std::initializer_list<const char*> kRests = {"As stored", "T-pose", "A-pose", "Supine"};

void draw_clip_row(Context& context, Column& column) {
  std::vector<std::string> names;
  for (const auto& clip : context.document().clips) names.push_back(clip->name);
  int chosen = context.document().clip;
  const PathScope path(context.ui, "Clip");
  if (choice_field(context.ui, column.property("Clip"), names, chosen)) choose_clip(context, chosen);
}

void draw_match(Context& context, Column& column, const ClipOnRig& clip) {
  const Look& look = context.ui->look;
  const Rect rect = column.property("Retarget");
  const int moved = moved_bones(clip);
  const bool good = moved > 0;
  const Colour colour = good ? look.theme.ok : look.theme.warn;
  put_icon(look.fonts.regular, colour, Rect{rect.low, {rect.low.x + look.px(18), rect.high.y}},
           good ? icon::kOk : icon::kWarning);
  char text[64];
  std::snprintf(text, sizeof text, "%d / %d", moved, static_cast<int>(clip.armature()->bones.size()));
  const float button = look.px(64);
  put_text(context.ui, look.fonts.regular, colour,
           Rect{{rect.low.x + look.px(22), rect.low.y}, {rect.high.x - button - look.px(6), rect.high.y}}, text);
  operator_button(context, "motion.map", {{rect.high.x - button, rect.low.y}, rect.high}, "Map...");
}

// Draws a note that names the joints whose rest rotation was changed, because the rest pose in the motion's file
// differs from the rest pose that the user selected, such as a T-pose.
void draw_turned(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const ClipOnRig* clip = clip_on_rig(context);
  if (!clip || !clip->retarget() || clip->retarget()->turned_joints().empty()) return;
  const std::vector<int>& turned = clip->retarget()->turned_joints();
  const std::string first = clip->clip()->motion->joints[turned.front()].name;
  const std::string words = "Joints turned from the file's rest pose into the selected one: " + first +
                            (turned.size() > 1 ? " and " + std::to_string(turned.size() - 1) + " more" : "") + ".";
  const Rect row = column.row(34);
  put_wrapped(context.ui, look.fonts.small, look.theme.text2, {row.low.x + look.px(10), row.low.y},
              row.width() - look.px(20), words, 2);
}

}  // namespace

void draw_motion(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Clip* clip = shown_clip(context.document());
  if (column.begin_section("Motion", clip ? clip->name : "")) {
    column.space(4);
    if (!clip) {
      const Rect row = column.row(30);
      operator_button(context, "file.import_motion",
                      {{row.low.x + look.px(10), row.low.y}, {row.high.x - look.px(10), row.low.y + look.px(26)}},
                      "Import BVH...");
    } else {
      draw_clip_row(context, column);
      clip = shown_clip(context.document());  // read again: the user may have selected another clip in the row above
      const ClipOnRig* on_rig = clip_on_rig(context);
      if (clip && clip->motion && on_rig) {
        // The settings are copied here, because the fields below may replace the clip and free `on_rig`.
        bool mirrored = clip->retarget.mirror;
        const std::string problem = on_rig->problem();
        draw_match(context, column, *on_rig);
        choice_of_operators(context, column.property("Root motion"), "Root motion",
                            {"motion.travel_locked", "motion.travel_in_place", "motion.travel_free"});
        choice_of_operators(context, column.property("Reference pose"), "Reference pose",
                            {"motion.reference_found", "motion.reference_rest", "motion.reference_first"});
        choice_of_operators(context, column.property("Clip rest pose"), "Clip rest pose",
                            {"motion.rest_file", "motion.rest_t", "motion.rest_a", "motion.rest_anatomical"}, kRests);
        choice_of_operators(
            context, column.property("Rig rest pose"), "Rig rest pose",
            {"motion.rig_rest_file", "motion.rig_rest_t", "motion.rig_rest_a", "motion.rig_rest_anatomical"}, kRests);
        draw_turned(context, column);
        const Rect mirror = column.property("Options");
        if (checkbox(context.ui, "motion.mirror", mirror, "Mirror", mirrored)) run(context, "motion.mirror");
        if (ImGui::IsItemHovered())
          operator_tooltip(context, *find_operator(context.operators, "motion.mirror"), mirror);
        if (!problem.empty()) {
          const Rect row = column.row(40);
          put_wrapped(context.ui, look.fonts.small, look.theme.warn, {row.low.x + look.px(10), row.low.y},
                      row.width() - look.px(20), problem, 2);
        }
      } else if (clip && clip->strips && on_rig && !on_rig->problem().empty()) {
        const Rect row = column.row(40);
        put_wrapped(context.ui, look.fonts.small, look.theme.warn, {row.low.x + look.px(10), row.low.y},
                    row.width() - look.px(20), on_rig->problem(), 2);
      }
    }
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
