// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/timeline_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/motion/strips.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/motion/graph.h"
#include "editor/ui/ui.h"
#include "editor/viewport/numeric_input.h"

namespace limber::editor {

namespace {

constexpr double kFurthest = 1e7;     // frame numbers are clamped to plus or minus this
constexpr double kLeastScale = 0.01;  // a factor that scales the keys' frames has at least this absolute value

void show_under_pointer(Context& context) {
  const double frame =
      std::clamp(std::round(frame_at(*context.timeline, context.ui->input.pointer.x)), -kFurthest, kFurthest);
  show_frame(context, static_cast<int>(frame));
}

constexpr float kReach = 7;  // the pointer hits a key at most this far from the key's centre, pixels at scale 1

std::optional<int> key_under_pointer(const Context& context) {
  const Timeline& timeline = *context.timeline;
  const Clip* clip = shown_clip(context.document());
  if (!clip || !timeline.keys.contains(context.ui->input.pointer)) return std::nullopt;
  std::optional<int> nearest;
  float least = context.ui->look.px(kReach);
  for (int frame : frames_of(clip->keys))
    if (const float far = std::abs(x_of(timeline, frame) - context.ui->input.pointer.x); far <= least) {
      least = far;
      nearest = frame;
    }
  return nearest;
}

// Returns the shapes of a track's keys after time is scaled by a factor. The tangents are divided by the factor. A
// negative factor reverses time: the in and out tangents are swapped, and each span keeps its interpolation.
template <class Track>
KeyShapes scaled_shapes(const Track& track, const KeyShapes& shapes, const std::map<int, int>& frame_of,
                        double factor) {
  KeyShapes scaled;
  std::optional<Interpolation> before;
  for (const auto& [frame, to] : frame_of) {
    if (!track.contains(frame)) continue;
    KeyShape shape = shape_at(shapes, frame);
    shape.in /= factor;
    shape.out /= factor;
    if (factor < 0) {
      std::swap(shape.in, shape.out);
      std::swap(shape.next, before ? *before : before.emplace(shape.next));
    }
    scaled[frame] = shape;
  }
  if (before) scaled.begin()->second.next = *before;
  return scaled;
}

void scale_keys(Keys& keys, const std::map<int, int>& frame_of, double factor) {
  for (const auto& [bone, track] : keys.bones)
    for (const auto& [frame, shape] : scaled_shapes(track, shapes_of(keys, bone), frame_of, factor))
      set_shape(keys, bone, frame, shape);
  for (const auto& [frame, shape] : scaled_shapes(keys.root, keys.root_shapes, frame_of, factor))
    set_root_shape(keys, frame, shape);
  move_keys(keys, frame_of);
}

// Commits the move, scaling or copying of the selected keys as one edit. Does nothing if no key changes its frame.
//   clip  the shown clip when the change began; if a job has meanwhile shown another clip, nothing is changed
void commit_change(Context& context, const std::shared_ptr<const Clip>& clip, KeyChange change, double factor = 1) {
  const std::map<int, int> frame_of = std::exchange(context.timeline->moving, {});
  if (clip != graph_clip(context.document())) return;
  const bool any =
      std::any_of(frame_of.begin(), frame_of.end(), [](const auto& key) { return key.first != key.second; });
  if (!any) return;
  constexpr const char* kLabels[] = {"Move keys", "Scale keys", "Duplicate keys"};
  context.timeline->chosen.clear();
  for (const auto& [from, to] : frame_of) context.timeline->chosen.insert(to);
  edit_clip(context, kLabels[static_cast<int>(change)], PoseThen::FromClip, [&](Clip& next) {
    switch (change) {
      case KeyChange::Move: return move_keys(next.keys, frame_of);
      case KeyChange::Scale: return scale_keys(next.keys, frame_of, factor);
      case KeyChange::Duplicate: return copy_keys(next.keys, frame_of);
    }
  });
}

class ChangingKeys final : public Modal {
 public:
  ChangingKeys(Context& context, KeyChange change)
      : clip_(graph_clip(context.document())),
        change_(change),
        chosen_(context.timeline->chosen),
        pivot_(shown_frame(context)),
        began_(context.ui->input.pointer.x) {}

  bool moved(Context& context, const glm::vec2& pixels) override {
    way_ += pixels.x * (context.ui->input.down(Key::Shift) ? 0.1f : 1.0f);
    return show(context);
  }
  bool button(Context& context, const ButtonChanged& event) override {
    if (!event.down || event.button == MouseButton::Middle) return true;
    return event.button == MouseButton::Left ? confirm(context) : drop(context);
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (!event.down) return true;
    if (event.key == Key::Escape) return drop(context);
    if (event.key == Key::Return || event.key == Key::NumEnter || event.key == Key::Space) return confirm(context);
    if (number_.key(event.key)) show(context);
    return true;
  }
  bool frame(Context& context, double) override { return clip_ == graph_clip(context.document()) || drop(context); }
  void cancel(Context& context) override { context.timeline->moving.clear(); }
  std::vector<KeyHint> hints(const Context&) const override {
    char text[48];
    std::snprintf(text, sizeof text, change_ == KeyChange::Scale ? "Scale %.2f" : "Move %+.0f frames", value_);
    return {
        {{}, number_.typed() ? std::string(change_ == KeyChange::Scale ? "Scale " : "Move ") + number_.text() : text},
        {{"0-9"}, "Type a number"},
        {{"Enter"}, "Confirm"},
        {{"Esc"}, "Cancel"}};
  }

 private:
  bool show(Context& context) {
    const Timeline& timeline = *context.timeline;
    const double frames = way_ / std::max(1.0f, timeline.ruler.width()) * timeline.window.count;
    if (change_ == KeyChange::Scale) {
      const double reach = began_ - x_of(timeline, pivot_);
      value_ = number_.typed() ? number_.value() : std::abs(reach) < 1 ? 1 : (reach + way_) / reach;
    } else {
      value_ = number_.typed() ? std::round(number_.value()) : std::round(frames);
    }
    value_ = std::clamp(value_, -kFurthest, kFurthest);
    // A factor near 0 would move keys onto the same frame, where all but one would be lost, and would make tangents
    // infinite. So the factor is limited.
    if (change_ == KeyChange::Scale) value_ = std::copysign(std::max(std::abs(value_), kLeastScale), value_);
    auto& moving = context.timeline->moving;
    moving.clear();
    for (int frame : chosen_) {
      const double to = change_ == KeyChange::Scale ? pivot_ + std::round((frame - pivot_) * value_) : frame + value_;
      moving[frame] = static_cast<int>(std::clamp(to, -kFurthest, kFurthest));
    }
    context.ui->touch();
    return true;
  }
  bool confirm(Context& context) {
    commit_change(context, clip_, change_, value_);
    return false;
  }
  bool drop(Context& context) {
    cancel(context);
    return false;
  }

  std::shared_ptr<const Clip> clip_;
  KeyChange change_;
  std::set<int> chosen_;
  int pivot_;
  float began_, way_ = 0;
  double value_ = 0;
  TypedNumber number_;
};

// Selects the key at `frame` and drags the selected keys while the button is held. With Shift, adds the key to the
// selection, or removes it without a drag.
void drag_keys(Context& context, int frame) {
  Timeline& timeline = *context.timeline;
  const bool extend = context.ui->input.modifiers().shift;
  if (extend && timeline.chosen.contains(frame)) {
    timeline.chosen.erase(frame);
    return;
  }
  if (!extend && !timeline.chosen.contains(frame)) timeline.chosen.clear();
  timeline.chosen.insert(frame);
  const auto moved = [began = context.ui->input.pointer.x](Context& c, const glm::vec2&) {
    Timeline& t = *c.timeline;
    const int by = static_cast<int>(
        std::round((c.ui->input.pointer.x - began) / std::max(1.0f, t.ruler.width()) * t.window.count));
    t.moving.clear();
    for (int key : t.chosen) t.moving[key] = key + by;
  };
  context.interaction->drag =
      Drag{MouseButton::Left, moved,
           [clip = graph_clip(context.document())](Context& c) { commit_change(c, clip, KeyChange::Move); },
           [](Context& c) { c.timeline->moving.clear(); }};
}

}  // namespace

double frame_at(const Timeline& timeline, float x) {
  const Rect& ruler = timeline.ruler;
  return timeline.window.low + (x - ruler.low.x) / std::max(1.0f, ruler.width()) * timeline.window.count;
}

float x_of(const Timeline& timeline, double frame) {
  const Rect& ruler = timeline.ruler;
  return ruler.low.x + static_cast<float>((frame - timeline.window.low) / timeline.window.count) * ruler.width();
}

void fit_window_to_keys(Context& context) {
  const std::set<int>& chosen = context.timeline->chosen;
  const double low = *chosen.begin(), count = *chosen.rbegin() - low + 1;
  auto& window = context.timeline->window;
  window.count = std::max(kFewestFrames, 1.2 * count);
  window.low = low + count / 2 - window.count / 2;
}

void fit_window(Context& context) {
  const FrameRange range = playing_range(context.document());
  double low = range.low, high = range.high;
  if (const Clip* clip = shown_clip(context.document()); clip && clip->motion) {
    low = std::min<double>(low, clip->start);
    high = std::max<double>(high, clip->end());
  }
  if (const Clip* clip = shown_clip(context.document()); clip && clip->strips)
    if (const auto span = span_of(*clip->strips, clip->rate)) {
      low = std::min<double>(low, span->first);
      high = std::max<double>(high, span->last);
    }
  const double room = std::max(2.0, 0.03 * (high - low));
  context.timeline->window.low = low - room;
  context.timeline->window.count = high - low + 2 * room;
}

void press_timeline(Context& context) {
  if (const auto key = key_under_pointer(context)) {
    stop_playing(context);
    return drag_keys(context, *key);
  }
  context.timeline->play.on = false;
  context.timeline->chosen.clear();
  show_under_pointer(context);
  context.interaction->drag =
      Drag{MouseButton::Left, [](Context& c, const glm::vec2&) { show_under_pointer(c); }, settle_frame, drop_frame};
}

void box_keys(Context& context) {
  const glm::vec2 from = context.ui->input.pointer;
  const auto moved = [from](Context& c, const glm::vec2&) {
    c.timeline->box = Rect{glm::min(from, c.ui->input.pointer), glm::max(from, c.ui->input.pointer)};
  };
  const auto ended = [](Context& c) {
    Timeline& timeline = *c.timeline;
    if (!timeline.box || !shown_clip(c.document())) return;
    const Rect box = *std::exchange(timeline.box, std::nullopt);
    if (!c.ui->input.modifiers().shift) timeline.chosen.clear();
    for (int frame : frames_of(shown_clip(c.document())->keys))
      if (const float x = x_of(timeline, frame); x >= box.low.x && x <= box.high.x) timeline.chosen.insert(frame);
  };
  context.interaction->drag = Drag{MouseButton::Left, moved, ended, [](Context& c) { c.timeline->box.reset(); }};
}

void begin_changing_keys(Context& context, KeyChange change) {
  stop_playing(context);
  context.interaction->modal = std::make_unique<ChangingKeys>(context, change);
  context.interaction->modal_wrap = {};
}

void pan_timeline(Context& context) {
  context.interaction->drag = Drag{MouseButton::Middle, [](Context& c, const glm::vec2& by) {
                                     Timeline& timeline = *c.timeline;
                                     timeline.window.low -=
                                         by.x / std::max(1.0f, timeline.ruler.width()) * timeline.window.count;
                                   }};
}

}  // namespace limber::editor
