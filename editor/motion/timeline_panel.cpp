// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the timeline below the views. At its top is a bar with the play buttons and the fields for frame and range;
// under it are the ruler, the markers, the clip with the curve of the active bone's angle, and the keys.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/motion/graph_panel.h"
#include "editor/motion/strip_panel.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_faces.h"
#include "editor/motion/timeline_ruler.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr float kTransport = 34, kMarks = 20, kLane = 54, kKeys = 36, kLabels = 56, kThinRow = 16;
constexpr Colour kAngle = 0xFF5CB6FF;  // colour of the angle's curve, ABGR (RGB: FFB65C)

std::string number_text(int value) {
  // Inserts a space between groups of three digits.
  std::string digits = std::to_string(std::abs(value));
  for (int place = static_cast<int>(digits.size()) - 3; place > 0; place -= 3)
    digits.insert(static_cast<std::size_t>(place), " ");
  return (value < 0 ? "-" : "") + digits;
}

// ---- The bar with the play buttons

class Transport {
 public:
  Transport(Context& context, const Rect& bar)
      : context_(context),
        look_(context.ui->look),
        bar_(bar),
        x_(bar.low.x + look_.px(8)),
        right_(bar.high.x - look_.px(8)) {}

  void draw() {
    fill(bar_, look_.theme.head);
    fill({{bar_.low.x, bar_.high.y - look_.line()}, bar_.high}, look_.theme.void_);
    draw_right();
    const bool playing = context_.timeline->play.on;
    tool("motion.first");
    tool("motion.frame_back");
    {
      const Operator* op = find_operator(context_.operators, "motion.play");
      const Rect place = next(28);
      const std::string why = disabled_reason(context_, *op);
      if (button(context_.ui, "motion.play", place,
                 {playing ? icon::kPause : icon::kPlay, "", playing ? ButtonStyle::Soft : ButtonStyle::Plain,
                  why.empty()}))
        run(context_, *op);
      if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) operator_tooltip(context_, *op, place);
    }
    tool("motion.frame_forward");
    tool("motion.last");
    x_ += look_.px(4);
    tool("motion.loop");
    tool("motion.ping_pong");
    draw_speed();
    line();
    draw_frame();
    if (fits(190)) draw_range();
    line();
    draw_keying();
  }

 private:
  Rect next(float width) {
    const float height = look_.px(26), y = std::round(bar_.centre().y - height / 2);
    const Rect place{{x_, y}, {x_ + look_.px(width), y + height}};
    x_ = place.high.x + look_.px(4);
    return place;
  }
  bool fits(float width) const { return x_ + look_.px(width) < right_; }
  void tool(const char* id) {
    const Operator* op = find_operator(context_.operators, id);
    const bool on = op->checked && op->checked(context_);
    operator_button(context_, id, next(28), "", on ? ButtonStyle::Soft : ButtonStyle::Plain);
  }
  void line() {
    x_ += look_.px(4);
    fill({{x_, bar_.low.y + look_.px(9)}, {x_ + look_.line(), bar_.high.y - look_.px(9)}}, look_.theme.line2);
    x_ += look_.line() + look_.px(8);
  }
  void words(const std::string& text) {
    const float width = text_size(look_.fonts.regular, text).x;
    put_text(context_.ui, look_.fonts.regular, look_.theme.text2, Rect{{x_, bar_.low.y}, {x_ + width + 1, bar_.high.y}},
             text);
    x_ += width + look_.px(8);
  }

  void draw_right() {
    const bool wide = bar_.width() > look_.px(900);
    for (const char* id : {"motion.retarget", "file.import_motion"}) {
      const Operator* op = find_operator(context_.operators, id);
      if (!op) continue;
      const std::string label = !wide ? "" : std::string_view(id) == "file.import_motion" ? "Import BVH..." : op->label;
      const char* sign = std::string_view(id) == "file.import_motion" ? icon::kMotion : op->icon;
      const ButtonLook face{sign, label, ButtonStyle::Plain, disabled_reason(context_, *op).empty()};
      const float width = label.empty() ? look_.px(30) : width_of_button(context_.ui, face), height = look_.px(26),
                  y = std::round(bar_.centre().y - height / 2);
      const Rect place{{right_ - width, y}, {right_, y + height}};
      if (button(context_.ui, id, place, face)) run(context_, *op);
      if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) operator_tooltip(context_, *op, place);
      right_ = place.low.x - look_.px(6);
    }
  }

  void draw_speed() {
    const auto& playing = context_.timeline->play;
    char text[24];
    const bool slow = playing.on && playing.pictures_per_second > 0;
    if (slow) std::snprintf(text, sizeof text, "%.0f fps", playing.pictures_per_second);
    else
      std::snprintf(text, sizeof text,
                    playing.speed < 1 && playing.speed != 0.5 && playing.speed != 0.1 ? "%.2f\u00d7" : "%.1f\u00d7",
                    playing.speed);
    const Rect place = next(74);
    const Pressed pressed = press_area(context_.ui, "speed", place);
    fill(place, pressed.hovered ? look_.theme.hover : look_.theme.raised, look_.px(4));
    put_text(context_.ui, look_.fonts.mono, slow ? look_.theme.warn : look_.theme.text,
             Rect{{place.low.x + look_.px(8), place.low.y}, {place.high.x - look_.px(20), place.high.y}}, text);
    put_icon(look_.fonts.regular, look_.theme.text2, Rect{{place.high.x - look_.px(20), place.low.y}, place.high},
             icon::kOpened);
    if (pressed.hovered)
      tooltip(context_.ui, place, "Speed",
              slow ? "Drawn frames per second: some frames are skipped to keep the clip's speed."
                   : "Playing speed relative to the clip's own rate.");
    if (pressed.clicked) ImGui::OpenPopup("speeds");
    if (!ImGui::BeginPopup("speeds", ImGuiWindowFlags_NoMove)) return;
    context_.ui->place.region = Region::Popup;
    for (const char* id : {"motion.faster", "motion.slower", "motion.play_at_file_rate", "motion.loop",
                           "motion.ping_pong", "motion.show_seconds"})
      operator_menu_item(context_, id);
    context_.ui->place.region = Region::Bottom;
    ImGui::EndPopup();
  }

  // Draws a field for an integer.
  //   moved  called with the number during a drag; may be empty
  //   ended  called with the number when dragging or typing ends
  void number(const std::string& name, int value, const std::function<void(int)>& moved,
              const std::function<void(int)>& ended) {
    const float height = look_.px(22), y = std::round(bar_.centre().y - height / 2), width = look_.px(62);
    const Rect place{{x_, y}, {x_ + width, y + height}};
    x_ += width + look_.px(4);
    auto& edited = context_.field_edit->number;
    double number = edited.name == name ? edited.value : value;
    bool committed = false;
    if (number_field(context_.ui, name, place, number, -1e6, 1e6, "%.0f", "", false, committed)) {
      edited = {name, number};
      if (moved) moved(static_cast<int>(std::round(number)));
    }
    if (!committed || edited.name != name) return;
    const int wanted = static_cast<int>(std::round(edited.value));
    edited = {};
    ended(wanted);
  }

  void draw_frame() {
    words("Frame");
    number("Frame", shown_frame(context_), {}, [this](int frame) {
      stop_playing(context_);
      // A typed frame outside a clip with a motion is clamped to the clip's frames. For a clip without a motion, the
      // frame is not clamped, because keys may be set at any frame.
      const Clip* clip = shown_clip(context_.document());
      const FrameRange all = clip && clip->motion ? all_frames(*clip) : FrameRange{frame, frame};
      go_to_frame(context_, std::clamp(frame, all.low, all.high));
      if (frame < all.low || frame > all.high)
        context_.messages->info(
            "Frame " + std::to_string(frame) + " is outside the clip",
            clip->name + " has frames " + std::to_string(all.low) + " to " + std::to_string(all.high));
    });
    x_ += look_.px(4);
  }

  void draw_range() {
    words("Range");
    const FrameRange range = playing_range(context_.document());
    number("Range start", range.low, {}, [&](int frame) {
      set(std::min(frame, range.high), range.high);
      if (frame > range.high)
        context_.messages->info("The range begins at frame " + std::to_string(range.high),
                                "A range cannot begin after its end");
    });
    number("Range end", range.high, {}, [&](int frame) {
      set(range.low, std::max(range.low, frame));
      if (frame < range.low)
        context_.messages->info("The range ends at frame " + std::to_string(range.low),
                                "A range cannot end before its beginning");
    });
  }
  // Sets the playing range, which may reach beyond the clip's frames, and zooms out if part of it is not visible.
  void set(int low, int high) {
    edit_clip(context_, "Set range", PoseThen::Stays, [&](Clip& clip) {
      clip.range_start = low;
      clip.range_end = high;
    });
    const auto& window = context_.timeline->window;
    if (low < window.low || high > window.low + window.count) fit_window(context_);
  }

  void draw_keying() {
    const Operator* op = find_operator(context_.operators, "motion.insert_key");
    const bool enabled = disabled_reason(context_, *op).empty(), long_form = fits(170);
    const Rect place = next(long_form ? 124 : 30);
    const Pressed pressed = press_area(context_.ui, "motion.insert_key", place, enabled);
    fill(place,
         pressed.hovered && enabled ? look_.theme.hover
         : enabled                  ? look_.theme.raised
                                    : look_.theme.head,
         look_.px(4));
    put_icon(look_.fonts.regular, enabled ? look_.theme.select : look_.theme.text3,
             Rect{{place.low.x + look_.px(7), place.low.y}, {place.low.x + look_.px(23), place.high.y}}, icon::kKey);
    if (long_form) {
      put_text(context_.ui, look_.fonts.regular, enabled ? look_.theme.text : look_.theme.text3,
               Rect{{place.low.x + look_.px(29), place.low.y}, place.high}, "Insert key");
      put_key_caps(context_.ui, place.high.x - look_.px(7) - width_of_key_caps(context_.ui, {"I"}), place.centre().y,
                   {"I"});
    }
    if (pressed.hovered) operator_tooltip(context_, *op, place);
    if (pressed.clicked) run(context_, *op);
    if (!fits(30)) return;
    const Operator* automatic = find_operator(context_.operators, "motion.auto_key");
    const Rect dot = next(28);
    const Pressed on = press_area(context_.ui, "motion.auto_key", dot);
    fill(dot,
         on.hovered                    ? look_.theme.hover
         : context_.timeline->auto_key ? look_.theme.accent_soft
                                       : look_.theme.raised,
         look_.px(4));
    put_icon(look_.fonts.regular, context_.timeline->auto_key ? look_.theme.error : look_.theme.text3, dot, icon::kDot);
    if (on.hovered) operator_tooltip(context_, *automatic, dot);
    if (on.clicked) run(context_, *automatic);
  }

  Context& context_;
  const Look& look_;
  Rect bar_;
  float x_, right_;
};

// ---- The markers

// Draws the markers with their names and returns the rectangles that they cover. A marker's name stands on its right
// and is cut off before the next marker. The name of the last shown marker is drawn on its left if it does not fit on
// its right and there is more room on its left.
std::vector<Rect> draw_markers(Context& context) {
  const Look& look = context.ui->look;
  const Timeline& timeline = *context.timeline;
  const Clip* clip = shown_clip(context.document());
  std::vector<Rect> covered;
  if (!clip || timeline.marks.empty()) return covered;
  const Rect& row = timeline.marks;
  const float half = look.px(5), gap = look.px(9), y = std::round(row.centre().y) - look.px(4),
              end = row.high.x + look.px(kRulerEnds - 2);
  float begin = row.low.x;  // x where the free part of the row begins, pixels
  for (std::size_t i = 0; i < clip->markers.size(); ++i) {
    const Marker& marker = clip->markers[i];
    const float x = x_of(timeline, marker.frame);
    if (x < row.low.x - half || x > row.high.x + half) continue;
    const float next =
        i + 1 < clip->markers.size() ? std::min(end, x_of(timeline, clip->markers[i + 1].frame) - gap) : end;
    const float width = text_size(look.fonts.small, marker.name).x + 1, right = next - x - gap, left = x - gap - begin;
    ImGui::GetWindowDrawList()->AddTriangleFilled({x - half, y}, {x + half, y}, {x, y + look.px(9)}, look.theme.ok);
    const bool at_left = right < width && next == end && left > right;
    const Rect name = at_left
                          ? Rect{{x - gap - std::min(width, left), row.low.y}, {x - gap, row.high.y}}
                          : Rect{{x + gap, row.low.y}, {x + gap + std::min(width, std::max(0.0f, right)), row.high.y}};
    put_text(context.ui, look.fonts.small, look.theme.ok, name, marker.name);
    covered.push_back({{std::min(x - half, name.low.x), row.low.y}, {std::max(x + half, name.high.x), row.high.y}});
    begin = covered.back().high.x + gap;
  }
  return covered;
}

// ---- The curve of the active bone's angle

constexpr double kPerSample = 3;  // samples of the curve are at least this far apart, pixels at scale 1
// Each drawn frame computes at most this many samples of the curve, so that drawing stays fast.
constexpr std::size_t kAtOnce = 24;

float degrees_from_rest(const Pose& pose, int bone) {
  const glm::dquat& q = pose.rotation[bone];
  return static_cast<float>(glm::degrees(2 * std::atan2(std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z), std::abs(q.w))));
}

// Adds up to kAtOnce samples to the curve of the active bone's angle. While samples are missing, asks the editor to
// draw another frame, in which the next samples are added.
void sample_curve(Context& context, const ClipOnRig& clip, int bone, const Rect& lane) {
  Timeline& timeline = *context.timeline;
  auto& curve = timeline.curve;
  // Samples lie at integer frames, because a motion has no poses between frames.
  const double per_pixel = timeline.window.count / std::max(1.0f, lane.width());
  const int step = static_cast<int>(std::clamp(std::ceil(kPerSample * context.ui->look.scale * per_pixel), 1.0, 1e7));
  const int first = static_cast<int>(std::clamp(std::floor(timeline.window.low / step) * step, -1e8, 1e8));
  if (curve.clip != clip.clip().get() || curve.bone != bone || curve.first != first || curve.step != step)
    curve = {clip.clip().get(), bone, first, step, {}};
  const auto wanted = static_cast<std::size_t>(timeline.window.count / step) + 2;
  const int parent = clip.armature()->bones[bone].parent;
  for (std::size_t i = 0; i < kAtOnce && curve.angles.size() < wanted; ++i) {
    const Pose pose = clip.at(first + step * static_cast<int>(curve.angles.size()));
    curve.angles.emplace_back(degrees_from_rest(pose, bone), parent >= 0 ? degrees_from_rest(pose, parent) : 0.0f);
  }
  if (curve.angles.size() < wanted) context.ui->touch();
}

void draw_curve(Context& context, const Rect& bar) {
  const Timeline& timeline = *context.timeline;
  const ClipOnRig* clip = clip_on_rig(context);
  const int bone = context.selection->bone.value_or(-1);
  if (!clip || bone < 0 || bone >= std::ssize(clip->armature()->bones) || bar.height() < context.ui->look.px(40))
    return;
  sample_curve(context, *clip, bone, timeline.lane);
  const auto& angles = timeline.curve.angles;
  float most = 1;
  for (const glm::vec2& angle : angles) most = std::max({most, angle.x, angle.y});
  // The curve's highest point stays below the top of the bar, so that the clip's name has room above the curve.
  const float low = bar.high.y - context.ui->look.px(5), height = bar.height() - context.ui->look.px(32);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  ImGui::PushClipRect(im(bar.low), im(bar.high), true);
  const Colour colours[] = {kAngle, with_alpha(context.ui->look.theme.text3, 0.7f)};
  for (int line = clip->armature()->bones[bone].parent >= 0 ? 1 : 0; line >= 0; --line) {
    for (std::size_t i = 0; i < angles.size(); ++i)
      list.PathLineTo({x_of(timeline, timeline.curve.first + static_cast<double>(i) * timeline.curve.step),
                       low - height * angles[i][line] / most});
    list.PathStroke(colours[line], 0, (line == 0 ? 1.5f : 1.0f) * context.ui->look.scale);
  }
  ImGui::PopClipRect();
}

void draw_lane(Context& context) {
  const Look& look = context.ui->look;
  const Timeline& timeline = *context.timeline;
  const Clip* clip = shown_clip(context.document());
  if (!clip || (!clip->motion && !clip->strips)) return;
  const Rect& lane = timeline.lane;
  StripSpan span{clip->start, clip->end()};
  if (clip->strips) span = span_of(*clip->strips, clip->rate).value_or(span);
  const Rect bar = intersection(lane, {{std::round(x_of(timeline, span.first)), lane.low.y},
                                       {std::round(x_of(timeline, span.last + 1.0)), lane.high.y}});
  if (bar.empty()) return;
  fill(bar, look.theme.accent_soft, look.px(3));
  outline(bar, look.theme.accent, look.px(3), look.line());
  draw_curve(context, bar);
  const float y = bar.low.y + look.px(3), right = bar.high.x - look.px(6);
  float x = bar.low.x + look.px(10);
  const float name = std::min(text_size(look.fonts.semibold, clip->name).x + 1, right - x);
  if (name < look.px(20)) return;
  put_text(context.ui, look.fonts.semibold, look.theme.accent_text, Rect{{x, y}, {x + name, y + look.px(18)}},
           clip->name);
  x += name + look.px(14);
  char facts[128];
  const std::string frames = number_text(span.last - span.first + 1);
  const Document& document = context.document();
  const int bone = context.selection->bone.value_or(-1);
  const bool chosen = document.armature && bone >= 0 && bone < std::ssize(document.armature->bones);
  std::snprintf(facts, sizeof facts, "%.5g fps \u00b7 %s frames%s%.40s%s", clip->rate, frames.c_str(),
                chosen ? " \u00b7 " : "", chosen ? document.armature->bones[bone].name.c_str() : "",
                chosen ? " angle" : "");
  if (right - x > look.px(40))
    put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{x, y}, {right, y + look.px(18)}}, facts);
}

void draw_keys(Context& context) {
  const Look& look = context.ui->look;
  const Timeline& timeline = *context.timeline;
  const Clip* clip = shown_clip(context.document());
  if (!clip) return;
  const float y = std::round(timeline.keys.centre().y), half = look.px(6);
  for (int frame : frames_of(clip->keys)) {
    const auto moving = timeline.moving.find(frame);
    const float x = std::round(x_of(timeline, moving == timeline.moving.end() ? frame : moving->second));
    if (x < timeline.keys.low.x - half || x > timeline.keys.high.x + half) continue;
    const bool chosen = timeline.chosen.contains(frame) || frame == shown_frame(context);
    ImGui::GetWindowDrawList()->AddQuadFilled({x, y - half}, {x + half, y}, {x, y + half}, {x - half, y},
                                              chosen ? look.theme.select : look.theme.text);
  }
  if (!timeline.box) return;
  const Rect box = intersection(*timeline.box, timeline.area);
  fill(box, with_alpha(look.theme.select, 0.15f));
  outline(box, look.theme.select, 0, look.line());
}

void place_rows(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Timeline& timeline = *context.timeline;
  const float left = rect.low.x + look.px(kLabels), right = rect.high.x - look.px(kRulerEnds);
  float y = rect.low.y;
  const auto row = [&](float height) {
    const Rect place{{left, y}, {right, std::min(y + height, rect.high.y)}};
    y = place.high.y;
    return place;
  };
  context.screen->timeline_area = timeline.area = {{left, y}, {right, rect.high.y}};
  timeline.ruler = row(look.px(kRulerHeight));
  // If there is little height for the timeline, its rows are thinner. If there is very little, the row of markers is
  // left out.
  const float rest = rect.high.y - y;
  timeline.marks = rest > look.px(kMarks + 34 + 20) ? row(look.px(kMarks))
                   : rest >= look.px(3 * kThinRow)  ? row(look.px(kThinRow))
                                                    : Rect{};
  const float keys = std::clamp((rect.high.y - y) * 0.35f, look.px(kThinRow), look.px(kKeys));
  timeline.lane = row(std::clamp(rect.high.y - y - keys, look.px(kThinRow), look.px(kLane)));
  timeline.keys = row(keys);
}

}  // namespace

void draw_timeline(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Timeline& timeline = *context.timeline;
  const PathScope path(context.ui, "timeline");
  const Rect bar{rect.low, {rect.high.x, rect.low.y + look.px(kTransport)}};
  Transport(context, bar).draw();
  const Rect rows{{rect.low.x, bar.high.y}, rect.high};
  const Clip* clip = shown_clip(context.document());
  if (!clip) {
    context.screen->timeline_area = timeline.area = timeline.ruler = timeline.marks = timeline.lane =
        timeline.keys = {};
    context.screen->graph_area = {};
    if (empty_state(context.ui, rows, "No clip", "Import BVH...")) run(context, "file.import_motion");
    return;
  }
  context.screen->graph_area = {};
  if (!timeline.shows_graph && !timeline.shows_strips) place_rows(context, rows);
  const std::string fitted = clip->name + std::to_string(clip->start) + "+" + std::to_string(clip->end());
  if (timeline.window.clip != fitted) {
    timeline.window.clip = fitted;
    timeline.window.followed.reset();
    timeline.chosen.clear();
    fit_window(context);
  }
  follow_head(context);
  // The switch beside the ruler selects the rows, the graph editor or the strips.
  const bool wide = timeline.shows_graph || timeline.shows_strips;
  const glm::vec2 corner = rows.low + glm::vec2(look.px(wide ? 12 : 2), look.px(1));
  draw_face_switch(context, {corner, corner + glm::vec2(look.px(wide ? 64 : 53), look.px(kRulerHeight - 2))});
  if (!shown_clip(context.document())) return;
  if (timeline.shows_graph) return draw_graph(context, rows);
  if (timeline.shows_strips) return draw_strips(context, rows);
  for (const auto& [name, place] :
       {std::pair<const char*, Rect>{"Marks", timeline.marks}, {"Clip", timeline.lane}, {"Keys", timeline.keys}})
    if (!place.empty())
      put_text(context.ui, look.fonts.small, look.theme.text3,
               Rect{{rect.low.x + look.px(12), place.low.y}, {place.low.x - look.px(4), place.high.y}}, name);
  for (const auto& [name, place] : {std::pair<const char*, Rect>{"ruler", timeline.ruler},
                                    {"marks", timeline.marks},
                                    {"lane", timeline.lane},
                                    {"keys", timeline.keys}})
    register_widget(context.ui, name, place);
  ImGui::PushClipRect(im(timeline.area.low - glm::vec2(look.px(26), 0)),
                      im(timeline.area.high + glm::vec2(look.px(kRulerEnds), 0)), true);
  draw_ruler(context);
  draw_lane(context);
  const std::vector<Rect> covered = draw_markers(context);
  draw_keys(context);
  draw_play_head(context, covered);
  ImGui::PopClipRect();
}

}  // namespace limber::editor
