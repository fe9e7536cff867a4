// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/strip_properties_panel.h"

#include <algorithm>
#include <cmath>

#include "core/motion/clip_speed.h"
#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/motion/strip_view.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

constexpr double kFar = 1e6;  // a frame number beyond plus or minus this cannot be typed

// A field for one number of the active strip.
struct StripNumber {
  const char *title, *tip;
  double shown = 0, low = 0, high = 1;
  const char *format = "%.0f", *unit = "";
  bool filled = false;
  std::function<void(Strip&, double)> set;
};

// Draws the number field. While the user edits the number, the strips and the body show the change; when the user has
// finished, one edit is committed.
void draw_number(Context& context, const Rect& rect, const StripNumber& number) {
  auto& edited = context.field_edit->number;
  // The field is named after its strip, so that what is typed for one strip never changes another.
  const std::string who = active_strip(context)->name, name = std::string("Strip ") + number.title + " of " + who;
  double value = edited.name == name ? edited.value : number.shown;
  bool committed = false;
  if (number_field(context.ui, name, rect, value, number.low, number.high, number.format, number.unit, number.filled,
                   committed)) {
    edited = {name, value};
    preview_active_strip(context, [&](Strip& strip) { number.set(strip, value); });
  }
  if (rect.contains(context.ui->input.pointer) && !context.interaction->drag)
    tooltip(context.ui, rect, number.title, number.tip);
  if (!committed || edited.name != name) return;
  const double wanted = edited.value;
  edited = {};
  attempt(context, "Strip", [&](Context& c) {
    change_active_strip(c, std::string("Set strip's ") + number.title,
                        [&](Strip& strip) { number.set(strip, wanted); });
  });
}

void draw_row(Context& context, Column& column, const StripNumber& number) {
  if (active_strip(context)) draw_number(context, column.property(number.title), number);
}

int whole(double value) { return static_cast<int>(std::lround(value)); }

// Draws a check box for a flag of the strip.
void draw_flag(Context& context, const Rect& rect, const char* name, const char* tip, bool Strip::*flag) {
  const Strip* strip = active_strip(context);
  if (!strip) return;
  bool on = strip->*flag;
  const bool pressed = checkbox(context.ui, name, rect, name, on);
  if (rect.contains(context.ui->input.pointer)) tooltip(context.ui, rect, name, tip);
  if (pressed)
    change_active_strip(context, std::string("Set strip's ") + name, [&](Strip& changed) { changed.*flag = on; });
}

std::pair<Rect, Rect> halves(const Context& context, const Rect& rect) {
  const float middle = std::round(rect.centre().x), gap = context.ui->look.px(3);
  return {{rect.low, {middle - gap, rect.high.y}}, {{middle + gap, rect.low.y}, rect.high}};
}

void draw_name(Context& context, Column& column, const Strip& strip) {
  std::string name = strip.name;
  if (!text_field(context.ui, "Name of " + strip.name, column.property("Name"), name) || name.empty() ||
      name == strip.name)
    return;
  const std::string before = strip.name;
  const std::string unique = unique_strip_name(*shown_strips(context), name);
  change_active_strip(context, "Rename strip", [&](Strip& changed) { changed.name = unique; });
  StripView& view = strip_view(context.timeline);
  view.chosen.erase(before);
  view.chosen.insert(unique);
  view.active = unique;
}

void draw_clip(Context& context, Column& column, const Strip& strip) {
  std::vector<std::shared_ptr<const Clip>> sources;
  std::vector<std::string> names;
  int chosen = 0;
  for (const auto& clip : context.document().clips) {
    if (clip->strips) continue;
    if (clip == strip.clip) chosen = static_cast<int>(sources.size());
    sources.push_back(clip);
    names.push_back(clip->name);
  }
  const PathScope path(context.ui, "Strip clip");
  if (!choice_field(context.ui, column.property("Clip"), names, chosen)) return;
  change_active_strip(context, "Set strip's clip", [&](Strip& changed) {
    changed.clip = sources[static_cast<std::size_t>(chosen)];
    changed.first = changed.clip->range_start;
    changed.last = std::max(changed.first, changed.clip->range_end);
    changed.skip = 0;
  });
}

void draw_time(Context& context, Column& column, const Strip& strip) {
  draw_row(context, column,
           {"Start", "The frame at which the strip begins.", double(strip.start), -kFar, kFar, "%.0f", "", false,
            [](Strip& s, double value) { s.start = whole(value); }});
  if (!active_strip(context)) return;
  const auto [first, last] = halves(context, column.property("Frames"));
  draw_number(context, first,
              {"First frame", "First frame of the clip that the strip plays.", double(strip.first), -kFar, kFar, "%.0f",
               "", false, [](Strip& s, double value) { s.first = std::min(whole(value), s.last); }});
  if (!active_strip(context)) return;
  draw_number(context, last,
              {"Last frame", "Last frame of the clip that the strip plays.", double(active_strip(context)->last), -kFar,
               kFar, "%.0f", "", false, [](Strip& s, double value) { s.last = std::max(whole(value), s.first); }});
  if (const Strip* now = active_strip(context))
    draw_row(context, column,
             {"Speed", "2 plays twice as fast, 0.5 half as fast.", now->speed, kSlowest, kFastest, "%.2f", "\u00d7",
              false, [](Strip& s, double value) { s.speed = value; }});
  if (const Strip* now = active_strip(context))
    draw_row(context, column,
             {"Repeat", "How many times the strip plays its frames.", now->repeat, 0.01, 1000, "%.2f", "\u00d7", false,
              [](Strip& s, double value) { s.repeat = value; }});
}

void draw_blend(Context& context, Column& column, const Strip& strip) {
  {
    int chosen = static_cast<int>(strip.blend);
    const PathScope path(context.ui, "Strip blend");
    if (choice_field(context.ui, column.property("Blend"), {"Replace", "Add", "Add since start"}, chosen))
      change_active_strip(context, "Set strip's blend",
                          [&](Strip& changed) { changed.blend = static_cast<StripBlend>(chosen); });
  }
  if (const Strip* now = active_strip(context))
    draw_row(context, column,
             {"Influence",
              "How strongly the strip changes the pose that the tracks below it set: 0 = not at all, 1 = fully.",
              now->influence, 0, 1, "%.2f", "", true, [](Strip& s, double value) { s.influence = value; }});
  if (!active_strip(context)) return;
  const auto [in, out] = halves(context, column.property("Fade in, out"));
  draw_number(context, in,
              {"Fade in",
               "Number of frames in which the strip's influence grows from 0. Where strips of one track overlap, the "
               "later strip always fades in.",
               double(active_strip(context)->blend_in), 0, kLongestBlend, "%.0f", "", false,
               [](Strip& s, double value) { s.blend_in = whole(value); }});
  if (!active_strip(context)) return;
  draw_number(context, out,
              {"Fade out", "Number of frames at the strip's end in which its influence falls to 0.",
               double(active_strip(context)->blend_out), 0, kLongestBlend, "%.0f", "", false,
               [](Strip& s, double value) { s.blend_out = whole(value); }});
}

void draw_flags(Context& context, Column& column) {
  // The check boxes share the whole width of a row, because their labels do not fit into the width of a field.
  const auto row = [&] {
    const Rect all = column.row(26);
    const float edge = context.ui->look.px(10), gap = context.ui->look.px(2);
    return Rect{{all.low.x + edge, all.low.y + gap}, {all.high.x - edge, all.high.y - gap}};
  };
  const auto [backwards, mirrored] = halves(context, row());
  draw_flag(context, backwards, "Backwards", "Play the strip from its last frame to its first.", &Strip::reversed);
  draw_flag(context, mirrored, "Mirrored", "Swap left and right in the strip's motion.", &Strip::mirrored);
  const auto [holds, muted] = halves(context, row());
  draw_flag(context, holds, "Hold end", "Keep the strip's last pose after its end, until a later strip replaces it.",
            &Strip::holds);
  draw_flag(context, muted, "Muted", "Switch the strip off.", &Strip::muted);
  draw_flag(context, row(), "Repeats travel",
            "Begin each repeat at the position and heading where the repeat before it ended.", &Strip::goes_on);
}

// Draws two buttons that run operators, in one row.
void draw_deeds(Context& context, Column& column, const std::string& title, const char* set, const char* words,
                const char* clear) {
  const Look& look = context.ui->look;
  const Rect rect = column.property(title);
  const float gap = look.px(4), reset = look.px(52);
  const Rect second{{rect.high.x - reset, rect.low.y}, rect.high};
  const Rect first{rect.low, {second.low.x - gap, rect.high.y}};
  operator_button(context, set, first, words);
  if (active_strip(context)) operator_button(context, clear, second, "Clear");
}

void draw_reach(Context& context, Column& column, const Strip& strip) {
  const std::string bones = strip.bones ? std::to_string(strip.bones->size()) : "all";
  draw_deeds(context, column, "Bones: " + bones, "strips.bones_selected", "Selected", "strips.bones_all");
  if (const Strip* now = active_strip(context))
    draw_deeds(context, column, now->place == GroundMove{} ? "Position: of clip" : "Position: moved",
               "strips.begin_here", "At the body", "strips.clear_place");
}

}  // namespace

void draw_strip_properties(Context& context, Column& column) {
  if (!active_strip(context)) return;
  if (column.begin_section("Strip", active_strip(context)->name)) {
    column.space(4);
    // The active strip is read again before each row, because an edit replaces the strips.
    draw_name(context, column, *active_strip(context));
    if (const Strip* strip = active_strip(context)) draw_clip(context, column, *strip);
    if (const Strip* strip = active_strip(context)) draw_time(context, column, *strip);
    if (const Strip* strip = active_strip(context)) draw_blend(context, column, *strip);
    if (active_strip(context)) draw_flags(context, column);
    if (const Strip* strip = active_strip(context)) draw_reach(context, column, *strip);
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
