// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/graph_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/motion/graph_edits.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/ui.h"
#include "editor/viewport/numeric_input.h"

namespace limber::editor {

namespace {

constexpr float kReach = 8;  // the pointer hits a key or a handle's end at most this far away, pixels at scale 1
constexpr float kStart = 3;  // a press on a key becomes a drag after the pointer has moved this far, pixels at scale 1
constexpr float kLeastThird = 2;                   // a handle narrower than this is not drawn, pixels at scale 1
constexpr double kStep = 1.25, kMostFrames = 1e7;  // zoom factor per wheel step; the most frames that the graph shows
// Zooming keeps the height of the plot between these limits, degrees or mm.
constexpr double kLeastValues = 1e-3, kMostValues = 1e7;
// A drag moves a key by at most this: frames, and degrees or mm.
constexpr double kFurthestMove = 1e7;

// Shows `keys` instead of the clip's keys, in the graph and in the body's pose.
void preview(Context& context, Keys keys) {
  Graph& graph = graph_of(context);
  const ClipOnRig* on_rig = clip_on_rig(context);
  if (on_rig) {
    Clip clip = *on_rig->clip();
    clip.keys = keys;
    show_pose(
        context,
        ClipOnRig(std::make_shared<const Clip>(std::move(clip)), on_rig->armature(), on_rig).at(shown_frame(context)));
  }
  graph.preview = std::move(keys);
  graph.previewed = graph_clip(context.document());
  context.ui->touch();
}

void drop_preview(Context& context) {
  Graph& graph = graph_of(context);
  graph.preview.reset();
  graph.previewed.reset();
  drop_shown_pose(context);
  context.ui->touch();
}

// A drag of selected keys, with the keys and curves from the moment when it began. If a job has meanwhile replaced the
// shown clip, the drag changes nothing.
struct Moving {
  std::shared_ptr<const Clip> clip;
  Keys keys;
  GraphCurves curves;
  std::set<GraphKey> chosen;

  explicit Moving(Context& context)
      : clip(graph_clip(context.document())),
        keys(clip->keys),
        curves(graph_of(context).curves),
        chosen(chosen_graph_keys(context)) {}

  bool is_shown(const Context& context) const { return clip.get() == shown_clip(context.document()); }

  void show(Context& context, const Keys& changed) const {
    if (is_shown(context)) preview(context, changed);
    else drop_preview(context);
  }
  void show(Context& context, GraphChange change, const GraphMap& time, const GraphMap& value) const {
    show(context, change == GraphChange::Duplicate ? with_keys_copied(curves, keys, chosen, time, value)
                                                   : with_keys_changed(curves, keys, chosen, time, value));
    graph_of(context).chosen = mapped_keys(time, chosen);
  }
  void cancel(Context& context) const {
    drop_preview(context);
    graph_of(context).chosen = chosen;
  }
  void commit(Context& context, const std::string& label) const {
    Graph& graph = graph_of(context);
    const std::optional<Keys> changed = std::exchange(graph.preview, std::nullopt);
    drop_preview(context);
    if (!changed || !is_shown(context) || *changed == keys) return;
    remember_chosen(graph, clip, chosen);
    edit_clip(context, label, PoseThen::FromClip, [&](Clip& next) { next.keys = *changed; });
    remember_chosen(graph, graph_clip(context.document()), graph.chosen);
  }
};

double frames_of_pixels(const Timeline& timeline, float pixels) {
  return pixels / std::max(1.0f, timeline.ruler.width()) * timeline.window.count;
}
double value_of_pixels(const Graph& graph, float pixels) {
  return -pixels / std::max(1.0f, graph.plot.height()) * (graph.high - graph.low);
}

constexpr const char* kChanges[] = {"Move keys in the graph", "Scale keys in the graph", "Duplicate keys in the graph"};

class ChangingGraphKeys final : public Modal {
 public:
  ChangingGraphKeys(Context& context, GraphChange change)
      : moving_(context),
        change_(change),
        scales_(change == GraphChange::Scale),
        pivot_frame_(shown_frame(context)) {
    double low = INFINITY, high = -INFINITY;
    for (const GraphKey& key : moving_.chosen) {
      const double value = graph_values(moving_.curves, key.channel.track, key.frame)[key.channel.axis];
      low = std::min(low, value), high = std::max(high, value);
    }
    pivot_value_ = (low + high) / 2;
    reach_ = context.ui->input.pointer -
             glm::vec2(x_of(*context.timeline, pivot_frame_), graph_y(graph_of(context), pivot_value_));
  }

  bool moved(Context& context, const glm::vec2& pixels) override {
    way_ += pixels * (context.ui->input.down(Key::Shift) ? 0.1f : 1.0f);
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
    if (event.key == Key::X || event.key == Key::Y) {
      const Lock wanted = event.key == Key::X ? Lock::Time : Lock::Value;
      lock_ = lock_ == wanted ? Lock::None : wanted;
      return show(context);
    }
    if (number_.key(event.key)) show(context);
    return true;
  }
  bool frame(Context& context, double) override { return moving_.is_shown(context) || drop(context); }
  void cancel(Context& context) override { moving_.cancel(context); }
  std::vector<KeyHint> hints(const Context&) const override {
    return {{{}, words()},          {{"X"}, "Time only"}, {{"Y"}, "Value only"}, {{"0-9"}, "Type a number"},
            {{"Enter"}, "Confirm"}, {{"Esc"}, "Cancel"}};
  }

 private:
  enum class Lock { None, Time, Value };

  std::string words() const {
    char time[32], value[32];
    std::snprintf(time, sizeof time, scales_ ? "time %.2f" : "%+.0f frames", scales_ ? time_.scale : time_.shift);
    std::snprintf(value, sizeof value, scales_ ? "value %.2f" : "%+.3g", scales_ ? value_.scale : value_.shift);
    const std::string what = scales_ ? "Scale " : "Move ";
    if (number_.typed()) return what + number_.text() + (scales_ || lock_ == Lock::Value ? "" : " frames");
    return what + (lock_ == Lock::Time    ? std::string(time)
                   : lock_ == Lock::Value ? std::string(value)
                                          : std::string(time) + ", " + value);
  }

  // Computes the linear maps that scale the keys: frames about the play head, and values about the middle of the keys'
  // values.
  void scale() {
    const auto ratio = [](float reach, float way) { return std::abs(reach) < 1 ? 1.0 : (reach + way) / double{reach}; };
    const float far = glm::length(reach_);
    const double both = far < 1 ? 1 : glm::length(reach_ + way_) / far;
    double by = lock_ == Lock::Time ? ratio(reach_.x, way_.x) : lock_ == Lock::Value ? ratio(reach_.y, way_.y) : both;
    if (number_.typed()) by = number_.value();
    const double in_time = std::clamp(by, 0.01, 100.0), in_value = std::clamp(by, -100.0, 100.0);
    time_ = lock_ == Lock::Value ? GraphMap{} : GraphMap{in_time, pivot_frame_ * (1 - in_time)};
    value_ = lock_ == Lock::Time ? GraphMap{} : GraphMap{in_value, pivot_value_ * (1 - in_value)};
  }

  void move(const Context& context) {
    double frames = frames_of_pixels(*context.timeline, way_.x);
    double value = value_of_pixels(*context.timeline->graph, way_.y);
    if (number_.typed()) {
      // If no axis is locked, a typed number is a number of frames, as in the timeline.
      frames = number_.value();
      value = lock_ == Lock::Value ? number_.value() : 0;
    }
    time_ = {1, lock_ == Lock::Value ? 0 : std::round(std::clamp(frames, -kFurthestMove, kFurthestMove))};
    value_ = {1, lock_ == Lock::Time ? 0 : std::clamp(value, -kFurthestMove, kFurthestMove)};
  }

  bool show(Context& context) {
    if (scales_) scale();
    else move(context);
    moving_.show(context, change_, time_, value_);
    return true;
  }
  bool confirm(Context& context) {
    moving_.commit(context, kChanges[static_cast<int>(change_)]);
    return false;
  }
  bool drop(Context& context) {
    cancel(context);
    return false;
  }

  Moving moving_;
  GraphChange change_;
  bool scales_;
  int pivot_frame_;
  double pivot_value_ = 0;
  // Vector from the pivot to the pointer when the drag began, and the pointer's motion since then, pixels.
  glm::vec2 reach_{0}, way_{0};
  Lock lock_ = Lock::None;
  GraphMap time_, value_;
  TypedNumber number_;
};

std::optional<GraphKey> key_under_pointer(Context& context) {
  const Graph& graph = graph_of(context);
  const Keys& keys = graph_keys(context);
  std::optional<GraphKey> nearest;
  float least = context.ui->look.px(kReach);
  for (const auto& [track, curve] : graph.curves.tracks)
    for (const int frame : key_frames_of(keys, track))
      for (int axis = 0; axis < 3; ++axis) {
        const GraphKey key{{track, axis}, frame};
        if (!is_shown(graph, key.channel)) continue;
        // Of several keys at the same point, a selected key is preferred.
        const float far = glm::distance(graph_point(context.timeline, key), context.ui->input.pointer) -
                          (graph.chosen.contains(key) ? 0.5f : 0.0f);
        if (far > least) continue;
        least = far;
        nearest = key;
      }
  return nearest;
}

void drag_handle(Context& context, const GraphHandle& handle) {
  const auto begun = std::make_shared<const Moving>(context);
  const auto moved = [=](Context& c, const glm::vec2&) {
    const Graph& graph = graph_of(c);
    const double whole = *handle_frames(begun->curves, handle.key.channel.track, handle.key.frame, handle.side);
    const double side = handle.side == KeySide::In ? -1 : 1;
    // The handle must stay on its side of the key. If the pointer crosses the key, the slope uses a tenth of the
    // handle's length.
    const double frames =
        std::max(0.1 * whole, side * frames_of_pixels(*c.timeline, c.ui->input.pointer.x - handle.key_point.x));
    const double value = value_of_pixels(graph, c.ui->input.pointer.y - handle.key_point.y);
    begun->show(c, with_slope(begun->curves, begun->keys, handle.key, handle.side, side * value / frames));
  };
  context.interaction->drag = Drag{MouseButton::Left, moved, [begun](Context& c) { begun->commit(c, "Move handle"); },
                                   [begun](Context& c) { begun->cancel(c); }};
}

void drag_key(Context& context, const GraphKey& key) {
  Graph& graph = graph_of(context);
  const bool extend = context.ui->input.modifiers().shift;
  if (extend && graph.chosen.contains(key)) {
    graph.chosen.erase(key);
    return;
  }
  if (!extend && !graph.chosen.contains(key)) graph.chosen.clear();
  graph.chosen.insert(key);
  const auto begun = std::make_shared<const Moving>(context);
  const auto moved = [begun, from = context.ui->input.pointer](Context& c, const glm::vec2&) {
    const glm::vec2 way = c.ui->input.pointer - from;
    if (!graph_of(c).preview && glm::length(way) < c.ui->look.px(kStart)) return;
    begun->show(c, GraphChange::Move, {1, std::round(frames_of_pixels(*c.timeline, way.x))},
                {1, value_of_pixels(graph_of(c), way.y)});
  };
  context.interaction->drag = Drag{MouseButton::Left, moved, [begun](Context& c) { begun->commit(c, kChanges[0]); },
                                   [begun](Context& c) { begun->cancel(c); }};
}

void choose_in_box(Context& context, const Rect& box) {
  Graph& graph = graph_of(context);
  if (!context.ui->input.modifiers().shift) graph.chosen.clear();
  for (const auto& [track, curve] : graph.curves.tracks)
    for (const int frame : key_frames_of(graph_keys(context), track))
      for (int axis = 0; axis < 3; ++axis)
        if (const GraphKey key{{track, axis}, frame};
            is_shown(graph, key.channel) && box.contains(graph_point(context.timeline, key)))
          graph.chosen.insert(key);
}

void draw_box(Context& context) {
  const glm::vec2 from = context.ui->input.pointer;
  const auto moved = [from](Context& c, const glm::vec2&) {
    graph_of(c).box = Rect{glm::min(from, c.ui->input.pointer), glm::max(from, c.ui->input.pointer)};
  };
  const auto ended = [](Context& c) {
    const std::optional<Rect> box = std::exchange(graph_of(c).box, std::nullopt);
    if (!shown_clip(c.document())) return;
    if (box) choose_in_box(c, *box);
    else if (!c.ui->input.modifiers().shift) graph_of(c).chosen.clear();
  };
  context.interaction->drag = Drag{MouseButton::Left, moved, ended, [](Context& c) { graph_of(c).box.reset(); }};
}

}  // namespace

glm::vec2 graph_point(const Timeline& timeline, const GraphKey& key) {
  const Graph& graph = *timeline.graph;
  const double value = graph_values(graph.curves, key.channel.track, key.frame)[key.channel.axis];
  return {x_of(timeline, key.frame), graph_y(graph, value)};
}

std::vector<GraphHandle> graph_handles(const Context& context) {
  std::vector<GraphHandle> handles;
  const Graph& graph = *context.timeline->graph;
  const Keys& keys = graph_keys(context);
  const double per_frame = context.timeline->ruler.width() / context.timeline->window.count;
  for (const GraphKey& key : graph.chosen) {
    const float x = x_of(*context.timeline, key.frame);
    if (x < graph.plot.low.x || x > graph.plot.high.x || !exists(graph, keys, key)) continue;
    const GraphTrack& track = key.channel.track;
    for (const KeySide side : {KeySide::In, KeySide::Out}) {
      const auto third = handle_frames(graph.curves, track, key.frame, side);
      if (!third || *third * per_frame < context.ui->look.px(kLeastThird)) continue;
      const double frames = side == KeySide::In ? -*third : *third;
      const auto speeds = graph_speeds(graph.curves, track, key.frame, side);
      const double value = graph_values(graph.curves, track, key.frame)[key.channel.axis];
      const glm::vec2 end(x_of(*context.timeline, key.frame + frames),
                          graph_y(graph, value + frames * (*speeds)[key.channel.axis]));
      const GraphHandle handle{key, side, graph_point(context.timeline, key), end};
      // A handle that is so close to its key could not be told from the key or pressed, so it is left out.
      if (glm::distance(handle.point, handle.key_point) > context.ui->look.px(kReach)) handles.push_back(handle);
    }
  }
  return handles;
}

void press_graph(Context& context) {
  stop_playing(context);
  settle_frame(context);
  update_curves(context);
  const std::vector<GraphHandle> handles = graph_handles(context);
  const auto nearest = std::min_element(handles.begin(), handles.end(), [&](const auto& a, const auto& b) {
    return glm::distance(a.point, context.ui->input.pointer) < glm::distance(b.point, context.ui->input.pointer);
  });
  if (nearest != handles.end() &&
      glm::distance(nearest->point, context.ui->input.pointer) <= context.ui->look.px(kReach))
    return drag_handle(context, *nearest);
  if (const auto key = key_under_pointer(context)) return drag_key(context, *key);
  draw_box(context);
}

void begin_changing_graph_keys(Context& context, GraphChange change) {
  stop_playing(context);
  settle_frame(context);
  update_curves(context);  // the curves may be outdated if the graph was not drawn since the keys changed
  context.interaction->modal = std::make_shared<ChangingGraphKeys>(context, change);
  context.interaction->modal_wrap = {};
}

void pan_graph(Context& context) {
  context.interaction->drag = Drag{MouseButton::Middle, [](Context& c, const glm::vec2& by) {
                                     Graph& graph = graph_of(c);
                                     c.timeline->window.low -= frames_of_pixels(*c.timeline, by.x);
                                     const double value = value_of_pixels(graph, by.y);
                                     graph.low -= value;
                                     graph.high -= value;
                                   }};
}

void zoom_graph(Context& context, ZoomAxes axes) {
  Graph& graph = graph_of(context);
  auto& window = context.timeline->window;
  const double factor = std::pow(kStep, -context.ui->input.wheel);
  if (axes != ZoomAxes::Value) {
    const double about = frame_at(*context.timeline, context.ui->input.pointer.x);
    const double fresh = std::clamp(window.count * factor, kFewestFrames, kMostFrames);
    window.low = about - (about - window.low) * fresh / window.count;
    window.count = fresh;
  }
  if (axes != ZoomAxes::Time) {
    const double about = graph_value_at(graph, context.ui->input.pointer.y), range = graph.high - graph.low;
    const double fresh = std::clamp(range * factor, kLeastValues, kMostValues);
    graph.low = about - (about - graph.low) * fresh / range;
    graph.high = graph.low + fresh;
  }
}

}  // namespace limber::editor
