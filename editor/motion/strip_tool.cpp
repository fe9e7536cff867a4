// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/strip_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/motion/moved_strips.h"
#include "editor/motion/graph.h"
#include "editor/motion/timeline_tool.h"
#include "editor/viewport/numeric_input.h"

namespace limber::editor {

namespace {

constexpr float kEnd = 6;          // the pointer trims a strip this close to the strip's end, pixels at scale 1
constexpr float kSnap = 8;         // a strip snaps to a frame this close to it, pixels at scale 1
constexpr float kStart = 3;        // the pointer moves this far before a press drags, pixels at scale 1
constexpr double kFurthest = 1e7;  // frames; a drag moves strips at most this far

double frames_of_pixels(const Timeline& timeline, float pixels) {
  return pixels / std::max(1.0f, timeline.ruler.width()) * timeline.window.count;
}

// Returns the frames to which dragged strips snap: the play head, and the ends of strips that stay.
std::vector<int> snap_frames(const Editor& editor, const Strips& strips, const std::set<std::string>& moving) {
  std::vector<int> frames{shown_frame(editor)};
  for (const StripTrack& track : strips.tracks)
    for (const Strip& strip : track.strips)
      if (!moving.contains(strip.name)) {
        frames.push_back(strip.start);
        frames.push_back(end_of(strip, strips_rate(editor)));
      }
  return frames;
}

// Returns the smallest change that moves `frame` to one of the targets; nothing if no target is near.
std::optional<int> snap_of(const Editor& editor, const std::vector<int>& targets, int frame) {
  const double reach = frames_of_pixels(*editor.timeline, editor.look.px(kSnap));
  std::optional<int> least;
  for (const int target : targets)
    if (std::abs(double(target) - frame) <= reach && (!least || std::abs(target - frame) < std::abs(*least)))
      least = target - frame;
  return least;
}

// The strips at the beginning of a drag, which changes them. If a job that ends during the drag shows another clip, the
// drag is dropped.
struct Begun {
  std::shared_ptr<const Clip> clip;
  Strips strips;
  std::set<std::string> chosen;
  StripView view;

  explicit Begun(Editor& editor)
      : clip(graph_clip(editor)),
        strips(*clip->strips),
        chosen(chosen_strips(editor)),
        view(strip_view(editor)) {}

  bool is_shown(const Editor& editor) const { return clip.get() == shown_clip(editor); }
  double rate() const { return clip->rate; }

  void cancel(Editor& editor) const {
    drop_strip_preview(editor);
    StripView& now = strip_view(editor);
    now.chosen = view.chosen;
    now.active = view.active;
  }
  void commit(Editor& editor, const std::string& label) const {
    const std::optional<Strips> changed = strip_view(editor).preview;
    drop_strip_preview(editor);
    if (!changed || !is_shown(editor) || *changed == *clip->strips) return;
    change_strips(editor, label, [&](Strips& next) { next = *changed; });
  }

  // Shows the strips moved as `wanted`, as far as they fit and after snapping, and returns the move that is shown.
  StripMove move(Editor& editor, StripMove wanted, bool snaps) const {
    std::optional<int> snap;
    if (snaps) {
      const std::vector<int> targets = snap_frames(editor, strips, chosen);
      for (const StripTrack& track : strips.tracks)
        for (const Strip& strip : track.strips) {
          if (!chosen.contains(strip.name)) continue;
          for (const int end : {strip.start, end_of(strip, rate())})
            if (const auto by = snap_of(editor, targets, end + wanted.frames);
                by && (!snap || std::abs(*by) < std::abs(*snap)))
              snap = by;
        }
    }
    wanted.frames += snap.value_or(0);
    const auto overlaps = editor.input.modifiers().shift ? Overlaps::Allowed : Overlaps::Avoided;
    const StripMove made = fitting_move(strips, chosen, wanted, rate(), overlaps);
    preview_strips(editor, moved_strips(strips, chosen, made));
    return made;
  }
};

class MovingStrips final : public Modal {
 public:
  MovingStrips(Editor& editor, Begun begun, std::string label)
      : begun_(std::move(begun)),
        label_(std::move(label)),
        from_(editor.input.pointer) {}

  bool moved(Editor& editor, const glm::vec2& pixels) override {
    way_ += pixels;
    return show(editor);
  }
  bool button(Editor& editor, const ButtonChanged& event) override {
    if (!event.down || event.button == MouseButton::Middle) return true;
    return event.button == MouseButton::Left ? confirm(editor) : drop(editor);
  }
  bool key(Editor& editor, const KeyChanged& event) override {
    if (event.key == Key::Shift || event.key == Key::Ctrl) return show(editor);
    if (!event.down) return true;
    if (event.key == Key::Escape) return drop(editor);
    if (event.key == Key::Return || event.key == Key::NumEnter || event.key == Key::Space) return confirm(editor);
    if (event.key == Key::X) {
      time_only_ = !time_only_;
      return show(editor);
    }
    if (number_.key(event.key)) show(editor);
    return true;
  }
  bool frame(Editor& editor, double) override { return begun_.is_shown(editor) || drop(editor); }
  void cancel(Editor& editor) override { begun_.cancel(editor); }
  std::vector<KeyHint> hints(const Editor&) const override {
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
  bool show(Editor& editor) {
    if (!begun_.is_shown(editor)) return drop(editor);  // a job that ended may have shown another clip
    const bool is_typed = number_.typed();
    const double frames = is_typed ? number_.value() : frames_of_pixels(*editor.timeline, way_.x);
    StripMove wanted{static_cast<int>(std::round(std::clamp(frames, -kFurthest, kFurthest))), 0};
    if (!time_only_) wanted.tracks = track_at(editor, from_.y + way_.y) - track_at(editor, from_.y);
    made_ = begun_.move(editor, wanted, !is_typed && !editor.input.modifiers().ctrl);
    return true;
  }
  bool confirm(Editor& editor) {
    begun_.commit(editor, label_);
    return false;
  }
  bool drop(Editor& editor) {
    cancel(editor);
    return false;
  }

  Begun begun_;
  std::string label_;
  glm::vec2 from_, way_{0};
  bool time_only_ = false;
  StripMove made_;
  TypedNumber number_;
};

void drag_strips(Editor& editor, const std::string& name) {
  StripView& view = strip_view(editor);
  const bool extend = editor.input.modifiers().shift, was_chosen = view.chosen.contains(name);
  if (!extend && !was_chosen) view.chosen.clear();
  view.chosen.insert(name);
  view.active = name;
  if (const auto place = find_strip(*shown_strips(editor), name))
    view.track = shown_strips(editor)->tracks[place->track].name;
  const auto begun = std::make_shared<const Begun>(editor);
  const auto moved = [begun, from = editor.input.pointer](Editor& e, const glm::vec2&) {
    const glm::vec2 way = e.input.pointer - from;
    if (!begun->is_shown(e)) return drop_strip_preview(e);
    if (!strip_view(e).preview && glm::length(way) < e.look.px(kStart)) return;
    const int tracks = track_at(e, e.input.pointer.y) - track_at(e, from.y);
    begun->move(e, {static_cast<int>(std::round(frames_of_pixels(*e.timeline, way.x))), tracks},
                !e.input.modifiers().ctrl);
  };
  const auto ended = [=](Editor& e) {
    const bool moved_at_all = strip_view(e).preview.has_value();
    begun->commit(e, "Move strips");
    if (moved_at_all) return;
    // A click on one of several selected strips selects it alone, or with Shift deselects it.
    if (extend && was_chosen) strip_view(e).chosen.erase(name);
    else if (!extend) strip_view(e).chosen = {name};
  };
  editor.drag = Drag{MouseButton::Left, moved, ended, [begun](Editor& e) { begun->cancel(e); }};
}

enum class StripEnd { Start, End };

void drag_end(Editor& editor, const std::string& name, StripEnd end) {
  choose_strip(editor, name);
  const auto begun = std::make_shared<const Begun>(editor);
  const auto moved = [=, from = editor.input.pointer](Editor& e, const glm::vec2&) {
    if (!begun->is_shown(e)) return drop_strip_preview(e);
    const auto place = find_strip(begun->strips, name);
    const Strip& before = begun->strips.tracks[place->track].strips[place->index];
    const int was = end == StripEnd::Start ? before.start : end_of(before, begun->rate());
    int frame = was + static_cast<int>(std::round(frames_of_pixels(*e.timeline, e.input.pointer.x - from.x)));
    if (!e.input.modifiers().ctrl) frame += snap_of(e, snap_frames(e, begun->strips, {name}), frame).value_or(0);
    Strips changed = begun->strips;
    StripTrack& track = changed.tracks[place->track];
    if (!e.input.modifiers().shift)
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
    preview_strips(e, std::move(changed));
  };
  editor.drag = Drag{MouseButton::Left, moved, [begun](Editor& e) { begun->commit(e, "Trim strip"); },
                     [begun](Editor& e) { begun->cancel(e); }};
}

void draw_strip_box(Editor& editor) {
  const glm::vec2 from = editor.input.pointer;
  const auto moved = [from](Editor& e, const glm::vec2&) {
    if (strip_view(e).box || glm::distance(from, e.input.pointer) >= e.look.px(kStart))
      strip_view(e).box = Rect{glm::min(from, e.input.pointer), glm::max(from, e.input.pointer)};
  };
  const auto ended = [from](Editor& e) {
    StripView& view = strip_view(e);
    const std::optional<Rect> box = std::exchange(view.box, std::nullopt);
    const Strips* strips = shown_strips(e);
    if (!strips) return;
    if (!e.input.modifiers().shift) view.chosen.clear(), view.active.clear();
    if (const int track = track_at(e, from.y); !box && track >= 0 && track < std::ssize(strips->tracks))
      view.track = strips->tracks[static_cast<std::size_t>(track)].name;
    for (std::size_t t = 0; box && t < strips->tracks.size(); ++t)
      for (std::size_t i = 0; i < strips->tracks[t].strips.size(); ++i)
        if (!intersection(*box, strip_rect(e, {t, i})).empty()) {
          view.chosen.insert(strips->tracks[t].strips[i].name);
          view.active = strips->tracks[t].strips[i].name;
        }
  };
  editor.drag = Drag{MouseButton::Left, moved, ended, [](Editor& e) { strip_view(e).box.reset(); }};
}

}  // namespace

void press_strips(Editor& editor) {
  stop_playing(editor);
  settle_frame(editor);
  const Strips& strips = *shown_strips(editor);
  const int t = track_at(editor, editor.input.pointer.y);
  if (t < 0 || t >= std::ssize(strips.tracks)) return draw_strip_box(editor);
  const auto track = static_cast<std::size_t>(t);
  // Where strips overlap, the later one is drawn on top, so it is hit first.
  for (std::size_t i = strips.tracks[track].strips.size(); i-- > 0;) {
    const Rect place = strip_rect(editor, {track, i});
    if (!place.contains(editor.input.pointer)) continue;
    const std::string name = strips.tracks[track].strips[i].name;
    const float end = std::min(editor.look.px(kEnd), place.width() / 4), x = editor.input.pointer.x;
    if (x < place.low.x + end) return drag_end(editor, name, StripEnd::Start);
    if (x > place.high.x - end) return drag_end(editor, name, StripEnd::End);
    return drag_strips(editor, name);
  }
  draw_strip_box(editor);
}

void begin_moving_strips(Editor& editor) {
  stop_playing(editor);
  settle_frame(editor);
  editor.modal = std::make_shared<MovingStrips>(editor, Begun(editor), "Move strips");
  editor.modal_wrap = {};
}

void begin_duplicating_strips(Editor& editor) {
  stop_playing(editor);
  settle_frame(editor);
  Begun begun(editor);
  const std::set<std::string> copies = add_copies(begun.strips, begun.chosen);
  begun.chosen = copies;
  StripView& view = strip_view(editor);
  view.chosen = copies;
  view.active = *copies.begin();
  begun.move(editor, {}, false);
  editor.modal = std::make_shared<MovingStrips>(editor, std::move(begun), "Duplicate strips");
  editor.modal_wrap = {};
}

void pan_strips(Editor& editor) {
  editor.drag = Drag{MouseButton::Middle, [](Editor& e, const glm::vec2& by) {
                       e.timeline->window.low -= frames_of_pixels(*e.timeline, by.x);
                       scroll_tracks(e, -by.y / e.look.scale);
                     }};
}

}  // namespace limber::editor
