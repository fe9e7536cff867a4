// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/strip_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/motion/moved_strips.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/motion/graph.h"
#include "editor/motion/timeline_tool.h"
#include "editor/ui/ui.h"
#include "editor/viewport/numeric_input.h"

namespace limber::editor {

namespace {

constexpr float kEnd = 6;  // a drag that begins at most this far from a strip's end trims the strip, pixels at scale 1
// A dragged strip snaps to a frame that is at most this far from its start or end, pixels at scale 1.
constexpr float kSnap = 8;
constexpr float kStart = 3;        // a press becomes a drag after the pointer has moved this far, pixels at scale 1
constexpr double kFurthest = 1e7;  // a drag moves strips by at most this many frames

double frames_of_pixels(const Timeline& timeline, float pixels) {
  return pixels / std::max(1.0f, timeline.ruler.width()) * timeline.window.count;
}

// Returns the frames to which dragged strips snap: that of the play head, and the starts and ends of all strips that
// are not dragged.
std::vector<int> snap_frames(const Context& context, const Strips& strips, const std::set<std::string>& moving) {
  std::vector<int> frames{shown_frame(context)};
  for (const StripTrack& track : strips.tracks)
    for (const Strip& strip : track.strips)
      if (!moving.contains(strip.name)) {
        frames.push_back(strip.start);
        frames.push_back(end_of(strip, strips_rate(context.document())));
      }
  return frames;
}

// Returns the smallest change that moves `frame` to one of the targets; nothing if no target is near.
std::optional<int> snap_of(const Context& context, const std::vector<int>& targets, int frame) {
  const double reach = frames_of_pixels(*context.timeline, context.ui->look.px(kSnap));
  std::optional<int> least;
  for (const int target : targets)
    if (std::abs(double(target) - frame) <= reach && (!least || std::abs(target - frame) < std::abs(*least)))
      least = target - frame;
  return least;
}

// The clip, its strips and the selection when a drag of strips began; Escape restores this selection. If a job ends
// during the drag and another clip is then shown, the drag ends without an edit.
struct Begun {
  std::shared_ptr<const Clip> clip;
  Strips strips;
  std::set<std::string> chosen;
  StripView view;

  explicit Begun(Context& context)
      : clip(graph_clip(context.document())),
        strips(*clip->strips),
        chosen(chosen_strips(context)),
        view(strip_view(context.timeline)) {}

  bool is_shown(const Context& context) const { return clip.get() == shown_clip(context.document()); }
  double rate() const { return clip->rate; }

  void cancel(Context& context) const {
    drop_strip_preview(context);
    StripView& now = strip_view(context.timeline);
    now.chosen = view.chosen;
    now.active = view.active;
  }
  void commit(Context& context, const std::string& label) const {
    const std::optional<Strips> changed = strip_view(context.timeline).preview;
    drop_strip_preview(context);
    if (!changed || !is_shown(context) || *changed == *clip->strips) return;
    change_strips(context, label, [&](Strips& next) { next = *changed; });
  }

  // Previews the selected strips after the move `wanted`. The move is changed if the strips snap to a frame or do not
  // fit at the new position. Returns the changed move.
  StripMove move(Context& context, StripMove wanted, bool snaps) const {
    std::optional<int> snap;
    if (snaps) {
      const std::vector<int> targets = snap_frames(context, strips, chosen);
      for (const StripTrack& track : strips.tracks)
        for (const Strip& strip : track.strips) {
          if (!chosen.contains(strip.name)) continue;
          for (const int end : {strip.start, end_of(strip, rate())})
            if (const auto by = snap_of(context, targets, end + wanted.frames);
                by && (!snap || std::abs(*by) < std::abs(*snap)))
              snap = by;
        }
    }
    wanted.frames += snap.value_or(0);
    const auto overlaps = context.ui->input.modifiers().shift ? Overlaps::Allowed : Overlaps::Avoided;
    const StripMove made = fitting_move(strips, chosen, wanted, rate(), overlaps);
    preview_strips(context, moved_strips(strips, chosen, made));
    return made;
  }
};

class MovingStrips final : public Modal {
 public:
  MovingStrips(Context& context, Begun begun, std::string label)
      : begun_(std::move(begun)),
        label_(std::move(label)),
        from_(context.ui->input.pointer) {}

  bool moved(Context& context, const glm::vec2& pixels) override {
    way_ += pixels;
    return show(context);
  }
  bool button(Context& context, const ButtonChanged& event) override {
    if (!event.down || event.button == MouseButton::Middle) return true;
    return event.button == MouseButton::Left ? confirm(context) : drop(context);
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (event.key == Key::Shift || event.key == Key::Ctrl) return show(context);
    if (!event.down) return true;
    if (event.key == Key::Escape) return drop(context);
    if (event.key == Key::Return || event.key == Key::NumEnter || event.key == Key::Space) return confirm(context);
    if (event.key == Key::X) {
      time_only_ = !time_only_;
      return show(context);
    }
    if (number_.key(event.key)) show(context);
    return true;
  }
  bool frame(Context& context, double) override { return begun_.is_shown(context) || drop(context); }
  void cancel(Context& context) override { begun_.cancel(context); }
  std::vector<KeyHint> hints(const Context&) const override {
    char text[48];
    std::snprintf(text, sizeof text, "Move %+d frames", made_.frames);
    return {{{}, number_.typed() ? "Move " + number_.text() + " frames" : text},
            {{"Shift"}, "Overlap to cross-fade"},
            {{"Ctrl"}, "Do not snap"},
            {{"X"}, "Time only"},
            {{"0-9"}, "Type a number"},
            {{"Enter"}, "Confirm"},
            {{"Esc"}, "Cancel"}};
  }

 private:
  bool show(Context& context) {
    // A background job that ended meanwhile may have shown another clip.
    if (!begun_.is_shown(context)) return drop(context);
    const bool is_typed = number_.typed();
    const double frames = is_typed ? number_.value() : frames_of_pixels(*context.timeline, way_.x);
    StripMove wanted{static_cast<int>(std::round(std::clamp(frames, -kFurthest, kFurthest))), 0};
    if (!time_only_) wanted.tracks = track_at(context, from_.y + way_.y) - track_at(context, from_.y);
    made_ = begun_.move(context, wanted, !is_typed && !context.ui->input.modifiers().ctrl);
    return true;
  }
  bool confirm(Context& context) {
    begun_.commit(context, label_);
    return false;
  }
  bool drop(Context& context) {
    cancel(context);
    return false;
  }

  Begun begun_;
  std::string label_;
  glm::vec2 from_, way_{0};
  bool time_only_ = false;
  StripMove made_;
  TypedNumber number_;
};

void drag_strips(Context& context, const std::string& name) {
  StripView& view = strip_view(context.timeline);
  const bool extend = context.ui->input.modifiers().shift, was_chosen = view.chosen.contains(name);
  if (!extend && !was_chosen) view.chosen.clear();
  view.chosen.insert(name);
  view.active = name;
  if (const auto place = find_strip(*shown_strips(context), name))
    view.track = shown_strips(context)->tracks[place->track].name;
  const auto begun = std::make_shared<const Begun>(context);
  const auto moved = [begun, from = context.ui->input.pointer](Context& c, const glm::vec2&) {
    const glm::vec2 way = c.ui->input.pointer - from;
    if (!begun->is_shown(c)) return drop_strip_preview(c);
    if (!strip_view(c.timeline).preview && glm::length(way) < c.ui->look.px(kStart)) return;
    const int tracks = track_at(c, c.ui->input.pointer.y) - track_at(c, from.y);
    begun->move(c, {static_cast<int>(std::round(frames_of_pixels(*c.timeline, way.x))), tracks},
                !c.ui->input.modifiers().ctrl);
  };
  const auto ended = [=](Context& c) {
    const bool moved_at_all = strip_view(c.timeline).preview.has_value();
    begun->commit(c, "Move strips");
    if (moved_at_all) return;
    // A click on one of several selected strips selects it alone, or with Shift deselects it.
    if (extend && was_chosen) strip_view(c.timeline).chosen.erase(name);
    else if (!extend) strip_view(c.timeline).chosen = {name};
  };
  context.interaction->drag = Drag{MouseButton::Left, moved, ended, [begun](Context& c) { begun->cancel(c); }};
}

enum class StripEnd { Start, End };

void drag_end(Context& context, const std::string& name, StripEnd end) {
  choose_strip(context, name);
  const auto begun = std::make_shared<const Begun>(context);
  const auto moved = [=, from = context.ui->input.pointer](Context& c, const glm::vec2&) {
    if (!begun->is_shown(c)) return drop_strip_preview(c);
    const auto place = find_strip(begun->strips, name);
    const Strip& before = begun->strips.tracks[place->track].strips[place->index];
    const int was = end == StripEnd::Start ? before.start : end_of(before, begun->rate());
    int frame = was + static_cast<int>(std::round(frames_of_pixels(*c.timeline, c.ui->input.pointer.x - from.x)));
    if (!c.ui->input.modifiers().ctrl) frame += snap_of(c, snap_frames(c, begun->strips, {name}), frame).value_or(0);
    Strips changed = begun->strips;
    StripTrack& track = changed.tracks[place->track];
    if (!c.ui->input.modifiers().shift)
      for (std::size_t i = 0; i < track.strips.size(); ++i) {
        const Strip& other = track.strips[i];
        const int other_end = end_of(other, begun->rate());
        if (i == place->index) continue;
        if (end == StripEnd::Start && other_end <= before.start) frame = std::max(frame, other_end);
        if (end == StripEnd::End && other.start >= was) frame = std::min(frame, other.start);
      }
    Strip& strip = track.strips[place->index];
    strip = end == StripEnd::Start ? with_start(strip, frame, begun->rate()) : with_end(strip, frame, begun->rate());
    sort_strips(track);
    preview_strips(c, std::move(changed));
  };
  context.interaction->drag = Drag{MouseButton::Left, moved, [begun](Context& c) { begun->commit(c, "Trim strip"); },
                                   [begun](Context& c) { begun->cancel(c); }};
}

void draw_strip_box(Context& context) {
  const glm::vec2 from = context.ui->input.pointer;
  const auto moved = [from](Context& c, const glm::vec2&) {
    if (strip_view(c.timeline).box || glm::distance(from, c.ui->input.pointer) >= c.ui->look.px(kStart))
      strip_view(c.timeline).box = Rect{glm::min(from, c.ui->input.pointer), glm::max(from, c.ui->input.pointer)};
  };
  const auto ended = [from](Context& c) {
    StripView& view = strip_view(c.timeline);
    const std::optional<Rect> box = std::exchange(view.box, std::nullopt);
    const Strips* strips = shown_strips(c);
    if (!strips) return;
    if (!c.ui->input.modifiers().shift) view.chosen.clear(), view.active.clear();
    if (const int track = track_at(c, from.y); !box && track >= 0 && track < std::ssize(strips->tracks))
      view.track = strips->tracks[static_cast<std::size_t>(track)].name;
    for (std::size_t t = 0; box && t < strips->tracks.size(); ++t)
      for (std::size_t i = 0; i < strips->tracks[t].strips.size(); ++i)
        if (!intersection(*box, strip_rect(c, {t, i})).empty()) {
          view.chosen.insert(strips->tracks[t].strips[i].name);
          view.active = strips->tracks[t].strips[i].name;
        }
  };
  context.interaction->drag =
      Drag{MouseButton::Left, moved, ended, [](Context& c) { strip_view(c.timeline).box.reset(); }};
}

}  // namespace

void press_strips(Context& context) {
  stop_playing(context);
  settle_frame(context);
  const Strips& strips = *shown_strips(context);
  const int t = track_at(context, context.ui->input.pointer.y);
  if (t < 0 || t >= std::ssize(strips.tracks)) return draw_strip_box(context);
  const auto track = static_cast<std::size_t>(t);
  // Where strips overlap, the later strip in the list is drawn on top, so it is tested first.
  for (std::size_t i = strips.tracks[track].strips.size(); i-- > 0;) {
    const Rect place = strip_rect(context, {track, i});
    if (!place.contains(context.ui->input.pointer)) continue;
    const std::string name = strips.tracks[track].strips[i].name;
    const float end = std::min(context.ui->look.px(kEnd), place.width() / 4), x = context.ui->input.pointer.x;
    if (x < place.low.x + end) return drag_end(context, name, StripEnd::Start);
    if (x > place.high.x - end) return drag_end(context, name, StripEnd::End);
    return drag_strips(context, name);
  }
  draw_strip_box(context);
}

void begin_moving_strips(Context& context) {
  stop_playing(context);
  settle_frame(context);
  context.interaction->modal = std::make_shared<MovingStrips>(context, Begun(context), "Move strips");
  context.interaction->modal_wrap = {};
}

void begin_duplicating_strips(Context& context) {
  stop_playing(context);
  settle_frame(context);
  Begun begun(context);
  const std::set<std::string> copies = add_copies(begun.strips, begun.chosen);
  begun.chosen = copies;
  StripView& view = strip_view(context.timeline);
  view.chosen = copies;
  view.active = *copies.begin();
  begun.move(context, {}, false);
  context.interaction->modal = std::make_shared<MovingStrips>(context, std::move(begun), "Duplicate strips");
  context.interaction->modal_wrap = {};
}

void pan_strips(Context& context) {
  context.interaction->drag = Drag{MouseButton::Middle, [](Context& c, const glm::vec2& by) {
                                     c.timeline->window.low -= frames_of_pixels(*c.timeline, by.x);
                                     scroll_tracks(c, -by.y / c.ui->look.scale);
                                   }};
}

}  // namespace limber::editor
