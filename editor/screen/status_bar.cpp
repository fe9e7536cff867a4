// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the status bar: key hints for the area under the pointer, the tissue under the pointer, the running job, and
// whether the project is saved.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "core/platform/local_time.h"
#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/panels.h"
#include "editor/context/pointer_context.h"
#include "editor/context/project_life.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/start_screen_state.h"
#include "editor/input/keymap.h"
#include "editor/labels/label_brush.h"
#include "editor/pose/live_preview.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/fem_overlay.h"
#include "editor/seams/seam_view.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/paint_region.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/volume/shown_image.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_change.h"

namespace limber::editor {

namespace {

constexpr std::size_t kFewHints = 5, kMostHints = 8;

// Returns key hints while modifier keys (Ctrl, Shift, Alt) are held. Each hint tells what a key or mouse button does
// together with the held modifiers in the area under the pointer.
std::vector<KeyHint> held_hints(const Context& context) {
  std::vector<KeyHint> all;
  std::vector<Chord> seen;
  for (const std::string& key_context : contexts(context)) {
    const auto bindings = context.keymap->contexts.find(key_context);
    if (bindings == context.keymap->contexts.end()) continue;
    for (const Binding& binding : bindings->second) {
      const Operator* op = find_operator(context.operators, binding.operator_id);
      if (!(binding.chord.modifiers == context.ui->input.modifiers()) ||
          std::find(seen.begin(), seen.end(), binding.chord) != seen.end())
        continue;
      seen.push_back(binding.chord);
      if (!op || !disabled_reason(context, *op).empty()) continue;
      Chord alone = binding.chord;
      alone.modifiers = {};
      all.push_back({key_caps(alone), op->label});
      // Add "drag" to the hint of a drag with the left button, because a click with this button does something else.
      if (alone.kind == Chord::Kind::Drag && alone.button == MouseButton::Left) all.back().caps.back() += " drag";
    }
  }
  // The status bar may have room for a few hints only. What the left button does with the modifiers comes first,
  // because this is what modifiers are mostly held for.
  std::stable_partition(all.begin(), all.end(),
                        [](const KeyHint& hint) { return hint.caps.back().starts_with("LMB"); });
  return all;
}

std::vector<KeyHint> hints(const Context& context) {
  if (context.interaction->modal) return context.interaction->modal->hints(context);
  if (context.interaction->drag) return {{{"Esc"}, "Cancel the drag"}};
  if (context.views->preview_visibility) return {{{"Ctrl"}, "Snap"}, {{"Esc"}, "Cancel the drag"}};
  if (context.dialogs->shown || !context.messages->errors.empty()) return {{{"Esc"}, "Close"}};
  if (!(context.ui->input.modifiers() == Modifiers{})) return held_hints(context);
  std::vector<std::pair<const char*, const char*>> operators;
  const ViewPlace* view = hovered_view(context);
  if (contexts(context).front() == "graph")
    operators = {{"graph.select", "Select"},
                 {"graph.move", "Move keys"},
                 {"graph.interpolation_menu", "Interpolation"},
                 {"graph.handle_menu", "Handles"},
                 {"graph.zoom", "Zoom"},
                 {"graph.pan", "Pan"},
                 {"graph.delete", "Delete keys"},
                 {"motion.next_face", "Next view"}};
  else if (contexts(context).front() == "strips")
    operators = {{"strips.select", "Select"},       {"strips.move", "Move"},   {"strips.add", "Add"},
                 {"strips.duplicate", "Duplicate"}, {"strips.split", "Split"}, {"strips.mute", "Mute"},
                 {"strips.delete", "Delete"},       {"strips.pan", "Pan"},     {"motion.next_face", "Next view"}};
  else if (contexts(context).front() == "timeline")
    operators = {{"motion.scrub", "Scrub"},
                 {"motion.zoom", "Zoom"},
                 {"motion.pan", "Pan"},
                 {"motion.insert_key", "Key"},
                 {"motion.move_keys", "Move keys"},
                 {"motion.delete_keys", "Delete keys"},
                 {"motion.marker", "Marker"},
                 {"motion.play", "Play"}};
  else if (view && context.workspace() == Workspace::Skin && context.skin->painting->labels->on)
    operators = {{"skin.paint", "Paint"},        {"skin.paint_subtract", "Erase"}, {"skin.radius", "Radius"},
                 {"skin.sample", "Pick tissue"}, {"slice.step", "Slice"},          {"edit.undo", "Undo"},
                 {"skin.brush_pie", "Brushes"}};
  else if (view && context.workspace() == Workspace::Skin && context.seams->brush)
    operators = {{"skin.paint", "Cut a seam"},
                 {"skin.paint_subtract", "Erase"},
                 {"skin.radius", "Radius"},
                 {"edit.undo", "Undo"},
                 {"skin.brush_pie", "Brushes"}};
  else if (view && context.workspace() == Workspace::Skin && why_not_paint(context).empty())
    operators = {{"skin.paint", rule_of(context.skin->painting->kind).name.c_str()},
                 {"skin.paint_subtract", "Subtract"},
                 {"skin.paint_smooth", "Smooth"},
                 {"skin.radius", "Radius"},
                 painted_region(context) ? std::pair{"skin.region_clear", "Clear region"}
                                         : std::pair{"skin.strength", "Strength"},
                 {"skin.pick_bone", "Pick bone"},
                 {"skin.flood", "Flood"},
                 {"skin.display_pie", "Display"}};
  else if (view && view->id != ViewId::Body)
    operators = {{"select.pick", context.interaction->tool == Tool::CrossHair ? "Move cross-hair" : "Select"},
                 {"slice.step", "Slice"},
                 {"slice.zoom", "Zoom"},
                 {"slice.pan", "Pan"},
                 {"view.place_cross_hair", "Cross-hair"},
                 {"slice.outline", "Outline"},
                 {"view.maximize", "Maximize"}};
  else if (!context.document().volume || context.start_screen->shown)
    operators = {{"file.open", "Open"},
                 {"file.new", "New"},
                 {"search.commands", "Search"},
                 {"help.guide", "Help"},
                 {"file.quit", "Quit"}};
  else if (context.workspace() == Workspace::Resample && !context.document().results.empty())
    operators = {{"compare.flicker", "Flicker A / B"},
                 {"compare.show_a", "A"},
                 {"compare.show_b", "B"},
                 {"compare.side_by_side", "Side by side"},
                 {"compare.wipe", "Wipe"},
                 {"compare.difference", "Difference"},
                 {"resample.run", "Resample"},
                 {"report.open", "Report"}};
  else if (context.workspace() == Workspace::Rig && context.selection->bone)
    operators = {{"rig.move", "Move"},   {"rig.rotate", "Rotate"}, {"rig.extrude", "Extrude"}, {"rig.delete", "Delete"},
                 {"view.orbit", "Turn"}, {"view.xray", "X-ray"},   {"select.all", "All bones"}};
  else if (context.workspace() == Workspace::Pose && context.selection->bone)
    operators = {{"pose.rotate", "Rotate"}, {"pose.move", "Move"},  {"pose.clear_rotation", "Clear"},
                 {"view.orbit", "Turn"},    {"view.xray", "X-ray"}, {"select.all", "All bones"}};
  else
    operators = {{"view.orbit", "Turn"},         {"view.pan", "Pan"},           {"view.zoom_step", "Zoom"},
                 {"view.xray", "X-ray"},         {"view.clip_box", "Clip box"}, {"view.hide", "Hide tissue"},
                 {"view.frame_all", "Frame all"}};
  std::vector<KeyHint> all;
  for (const auto& [id, words] : operators)
    if (const auto chord = context.keymap->chord_of(id, contexts(context));
        chord && find_operator(context.operators, id))
      all.push_back({key_caps(*chord), words});
  return all;
}

void draw_hints(Context& context, const Rect& bar, float right) {
  const Look& look = context.ui->look;
  float x = bar.low.x + look.px(10);
  std::size_t shown = 0;
  for (const KeyHint& hint : hints(context)) {
    if (shown++ == (context.screen->layout.few_hints && !context.interaction->modal ? kFewHints : kMostHints)) break;
    const float words = text_size(look.fonts.small, hint.words).x;
    if (x + width_of_key_caps(context.ui, hint.caps) + look.px(7) + words > right - look.px(16)) break;
    x = put_key_caps(context.ui, x, bar.centre().y, hint.caps) + look.px(7);
    put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{x, bar.low.y}, {x + words + 1, bar.high.y}},
             hint.words);
    x += words + look.px(12);
  }
}

// The icon, its colour, the text and the tooltip that tell whether the project is saved.
struct SavedState {
  const char* icon;
  Colour colour;
  std::string words, description;
};

SavedState saved_state(const Context& context) {
  const Theme& theme = context.ui->look.theme;
  const ProjectLife& life = context.life;
  if (!life.trouble.empty()) return {icon::kWarning, theme.warn, "No recovery", life.trouble};
  if (context.history->unsaved())
    return {icon::kDot, theme.select, "Not saved",
            life.session ? "Every edit is stored on disk and can be recovered after a crash." : ""};
  if (context.project->path.empty())
    return {"", theme.text2, "No project", "The open volume or rig has no project file yet."};
  std::string words = "Saved";
  if (life.saved_at > 0) {
    const std::tm local = local_time(life.saved_at);
    char time[16];
    std::strftime(time, sizeof time, " %H:%M", &local);
    words += time;
  }
  return {icon::kTick, theme.ok, words, context.project->path.string()};
}

// Draws a slot of the status bar that tells whether the project is saved. The slot ends at the x coordinate `right`.
// Returns the x coordinate at which the next slot to the left must end.
float draw_saved(Context& context, const Rect& bar, float right) {
  if (!context.document().volume) return right;
  const Look& look = context.ui->look;
  const SavedState state = saved_state(context);
  // The slot has the width of the widest text, so that its width never changes.
  const Rect slot{{right - text_size(look.fonts.small, "Saved 00:00").x - look.px(22), bar.low.y}, {right, bar.high.y}};
  if (*state.icon)
    put_icon(look.fonts.small, state.colour, Rect{slot.low, {slot.low.x + look.px(16), slot.high.y}}, state.icon);
  put_text(context.ui, look.fonts.small, look.theme.text2,
           Rect{{slot.low.x + look.px(20), slot.low.y}, {slot.high.x + 1, slot.high.y}}, state.words);
  if (press_area(context.ui, "Saved", slot).hovered && !state.description.empty())
    tooltip(context.ui, slot, state.words, state.description);
  return slot.low.x - look.px(12);
}

float draw_hover(Context& context, const Rect& bar, float right) {
  const Hover& hover = context.views->hover;
  if (!hover.view || !context.document().volume) return right;
  const Look& look = context.ui->look;
  const std::optional<double> value = image_value_at_pointer(context.views);
  std::string words = value ? "No label" : "Outside";
  char place[64] = "";
  if (hover.inside || value)
    std::snprintf(place, sizeof place, "%.1f %.1f %.1f mm", hover.point.x, hover.point.y, hover.point.z);
  if (hover.inside) {
    const Tissue* tissue = context.document().tissues ? context.document().tissues->find(hover.label) : nullptr;
    words = tissue ? shown_name(*tissue) : "Unknown";
    // A tissue without a name is shown as "Label" and a number, so its label is not added again.
    if (!tissue || !tissue->name.empty()) words += " \u00b7 label " + std::to_string(hover.label);
    if (!hover.weights.empty()) {
      char weight[16];
      std::snprintf(weight, sizeof weight, " %.3f", hover.weights[0].value);
      words += " \u00b7 " + hover.weights[0].bone + weight;
    }
  }
  if (value) words += " \u00b7 " + text_of_image_value(context.views, *value);
  const std::string measured = hover.inside ? measure_text_at(context, hover.voxel) : "";
  if (!measured.empty()) words += " \u00b7 " + measured;
  if (const std::string there = hover.inside ? other_side_text_at(context, hover.voxel) : ""; !there.empty())
    words += " \u00b7 " + there;
  const float mono = *place ? look.px(170) : 0,
              width = std::min(text_size(look.fonts.small, words).x + 1,
                               look.px(hover.weights.empty() && measured.empty() && !value ? 220 : 320));
  const float left = right - mono - width;
  if (*place)
    put_text(context.ui, look.fonts.small_mono, look.theme.text2, Rect{{right - mono, bar.low.y}, {right, bar.high.y}},
             place, Align::Right);
  put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{left, bar.low.y}, {left + width, bar.high.y}}, words);
  return left;
}

// Draws how much the pose changes the volume of all tissue, in a slot of the status bar that ends at the x coordinate
// `right`. Draws nothing while the sidebar is open, because the sidebar shows this figure too. Returns the x coordinate
// at which the next slot to the left must end.
float draw_volume_change(Context& context, const Rect& bar, float right) {
  LivePose& live = *context.live;
  if (context.workspace() != Workspace::Pose || !context.screen->layout.sidebar.empty() || !live.posed() ||
      !live.trouble().empty())
    return right;
  live.metrics().want();
  const PoseMetrics* known = live.metrics().known();
  const PoseMetrics* metrics = known ? known : live.metrics().last();
  if (!metrics) return right;
  const Look& look = context.ui->look;
  const auto change = metrics->total.change_percent();
  const Colour colour = known ? colour_of_change(look.theme, change) : look.theme.text3;
  const Rect slot{{right - text_size(look.fonts.small, "Volume +00.00 %").x - look.px(22), bar.low.y},
                  {right, bar.high.y}};
  put_icon(look.fonts.small, colour, Rect{slot.low, {slot.low.x + look.px(16), slot.high.y}},
           std::abs(change.value_or(0)) <= kSmallChange ? icon::kOk : icon::kWarning);
  put_text(context.ui, look.fonts.small, colour,
           Rect{{slot.low.x + look.px(20), slot.low.y}, {slot.high.x + 1, slot.high.y}}, "Volume " + percent(change));
  if (press_area(context.ui, "Volume change", slot).hovered)
    tooltip(
        context.ui, slot, "Volume " + percent(change),
        "Volume change of all tissue from rest to this pose. Press N to open the sidebar, which lists each tissue.");
  return slot.low.x - look.px(12);
}

}  // namespace

void draw_status_bar(Context& context) {
  const Look& look = context.ui->look;
  const Rect& bar = context.screen->layout.status;
  begin_region(context.ui, Region::Status, "status", bar, look.theme.head);
  fill({bar.low, {bar.high.x, bar.low.y + look.line()}}, look.theme.void_);
  float right = draw_saved(context, bar, bar.high.x - look.px(10));
  if (context.start_screen->shown) {
    const std::string words = "or drop a file on the window";
    put_text(context.ui, look.fonts.small, look.theme.text2,
             Rect{{right - text_size(look.fonts.small, words).x - 1, bar.low.y}, {right, bar.high.y}}, words);
  }
  right = draw_volume_change(context, bar, right);
  right = draw_job_slot(context, bar, right);
  right = draw_hover(context, bar, right);
  draw_hints(context, bar, right);
  end_region(context.ui);
}

}  // namespace limber::editor
