// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/transform_tool.h"

#include <cctype>
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/pointer_context.h"
#include "editor/context/screen.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr double kPrecise = 0.1;  // factor on the pointer's moves while Shift is held
// A press is a drag, and no click, if the pointer moves farther than this, pixels at scale 1.
constexpr double kClickPixels = 4;

constexpr const char* kAxisNames[] = {"X", "Y", "Z"};
constexpr double kFarthest = 10'000;  // a longer translation cannot be entered in the form, mm

int axis_of_key(Key key) { return key == Key::X ? 0 : key == Key::Y ? 1 : key == Key::Z ? 2 : -1; }

}  // namespace

ViewPlace place_of_tool(const Context& context) {
  if (const ViewPlace* hovered = hovered_view(context)) return *hovered;
  if (const Rect* body = context.screen->layout.place_of(ViewId::Body)) return {ViewId::Body, *body};
  return context.screen->layout.view_places.empty() ? ViewPlace{ViewId::Body, {{0, 0}, {1, 1}}}
                                                    : context.screen->layout.view_places.front();
}

std::string text_of_number(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

TransformTool::TransformTool(Context& context, const Grip& grip)
    : view_(context, place_of_tool(context)),
      lock_(grip.lock),
      held_(grip.held),
      pointer_(context.ui->input.pointer),
      start_(pointer_) {}

bool TransformTool::moved(Context& context, const glm::vec2& pixels) {
  const glm::dvec2 from = pointer_;
  pointer_ += glm::dvec2(pixels) * (context.ui->input.down(Key::Shift) ? kPrecise : 1.0);
  travelled_ = std::max(travelled_, glm::distance(pointer_, start_));
  follow(context, from, pointer_);
  show(context);
  return true;
}

// Locks the tool to the axis that is nearest to the direction in which the pointer has moved.
void TransformTool::lock_to_way(Context& context) {
  const Space space = context.transform_settings->space;
  const glm::dmat3 all = axes(space);
  const glm::dvec2 way = pointer_ - start_;
  double best = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec2 seen(glm::dot(all[axis], view_.right), -glm::dot(all[axis], view_.up));
    if (const double along = std::abs(glm::dot(seen, way)); along > best) {
      best = along;
      lock_ = {axis, space};
    }
  }
  locked(context);
  show(context);
}

bool TransformTool::button(Context& context, const ButtonChanged& event) {
  if (event.down && event.button == MouseButton::Middle) {
    lock_to_way(context);
    return true;
  }
  if (held_) {
    if (event.down && event.button == MouseButton::Right) return drop(context);
    if (event.button != *held_ || event.down) return true;
    if (travelled_ >= kClickPixels * context.ui->look.scale || number_.typed()) return confirm(context);
    drop(context);
    run(context, context.ui->input.down(Key::Shift) ? "select.extend" : "select.pick");
    return false;
  }
  if (!event.down) return true;
  return event.button == MouseButton::Left ? confirm(context) : drop(context);
}

bool TransformTool::key(Context& context, const KeyChanged& event) {
  if (!event.down) {
    if (event.key == Key::Ctrl || event.key == Key::Shift) show(context);
    return true;
  }
  if (event.key == Key::Escape) return drop(context);
  if (event.key == Key::Return || event.key == Key::NumEnter || event.key == Key::Space) return confirm(context);
  if (const int axis = axis_of_key(event.key); axis >= 0) {
    // The first press of X, Y or Z locks the axis of the selected space. The second press locks the axis of another
    // space: local space if global space is selected, else global space. The third press removes the lock.
    const bool plane = context.ui->input.down(Key::Shift);
    const Space first = context.transform_settings->space,
                second = first == Space::Global ? Space::Local : Space::Global;
    if (lock_.axis != axis || lock_.plane != plane) lock_ = {axis, first, plane};
    else if (lock_.space == first) lock_.space = second;
    else lock_ = {};
    locked(context);
  } else if (!number_.key(event.key) && !own_key(context, event.key)) {
    return true;
  }
  show(context);
  return true;
}

bool TransformTool::confirm(Context& context) {
  const auto again = [self = shared_from_this()](Context& c, const std::vector<FormField>& fields) {
    self->set(fields);
    self->keep(c);
  };
  act_and_allow_redo(context, parameters(), again, [this](Context& c) { keep(c); });
  return false;
}

std::vector<FormField> TransformTool::fields_of_way(const glm::dvec3& way) const {
  const Space space = lock_.axis < 0 ? Space::Global : lock_.space;
  const glm::dvec3 along = glm::transpose(axes(space)) * way;
  std::vector<FormField> fields;
  for (int axis = 0; axis < 3; ++axis)
    fields.push_back(number_of(kAxisNames[axis], "The distance to move along this axis.", along[axis], -kFarthest,
                               kFarthest, "%.2f", "mm"));
  fields.push_back(choice_of("Axes", "The coordinate system of X, Y and Z.", {"Global", "Local", "Parent", "View"},
                             static_cast<int>(space)));
  return fields;
}

void TransformTool::set_way(const std::vector<FormField>& fields) {
  way_ = axes(static_cast<Space>(fields[3].chosen)) * glm::dvec3(fields[0].value, fields[1].value, fields[2].value);
}

std::vector<FormField> TransformTool::fields_of_axis() const {
  return {choice_of(
              "Axis",
              "The axis to turn about or to scale along. None: turn about the line of sight, or scale along all axes.",
              {"None", "X", "Y", "Z"}, lock_.axis + 1),
          choice_of("Axes", "The coordinate system of X, Y and Z.", {"Global", "Local", "Parent", "View"},
                    static_cast<int>(lock_.space))};
}

void TransformTool::set_axis(const std::vector<FormField>& fields, std::size_t first) {
  lock_.axis = fields[first].chosen - 1;
  lock_.space = static_cast<Space>(fields[first + 1].chosen);
}

bool TransformTool::drop(Context& context) {
  cancel(context);
  return false;
}

double TransformTool::snapped(const Context& context, double value, double step, double fine) const {
  const double grid = context.ui->input.down(Key::Shift) ? fine : step;
  if (grid <= 0 || context.ui->input.down(Key::Ctrl) == context.transform_settings->snapping) return value;
  return std::round(value / grid) * grid;
}

glm::dvec3 TransformTool::lock_axis() const { return lock_.axis < 0 ? glm::dvec3(0) : axes(lock_.space)[lock_.axis]; }

std::string TransformTool::lock_text(const char* word) const {
  if (lock_.axis < 0) return "";
  std::string space = lock_.space == Space::Global ? "world" : name_of(lock_.space);
  space[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(space[0])));
  return std::string(" ") + (lock_.plane ? "across" : word) + " " + space + " " + "XYZ"[lock_.axis];
}

std::vector<KeyHint> TransformTool::shared_hints() const {
  return {{{"X", "Y", "Z"}, "Lock axis (twice: local)"},
          {{"0-9"}, "Value"},
          {{"Ctrl"}, "Snap"},
          {{"Shift"}, "Precise"},
          {{"Enter"}, "Confirm"},
          {{"Esc"}, "Cancel"}};
}

glm::dvec3 TransformTool::dragged(const Context& context, const glm::dvec3& from, double step, double fine) const {
  if (way_) return from + *way_;
  const glm::dvec3 axis = lock_axis();
  const bool free = axis == glm::dvec3(0), line = !free && !lock_.plane;
  if (number_.typed())
    return from + number_.value() * (line ? axis : lock_.plane ? axes(lock_.space)[(lock_.axis + 1) % 3] : view_.right);
  const std::optional<glm::dvec2> seen = view_.pixel_of(from);
  if (!seen) return from;
  // A handle that is dragged along a locked axis or plane stays under the pointer. In other cases the point moves by
  // the same number of pixels on the screen as the pointer.
  const glm::dvec2 begin = held_ && !free ? start_ : *seen, end = begin + (pointer_ - start_);
  if (line) {
    const auto first = view_.along_line(begin, from, axis), last = view_.along_line(end, from, axis);
    return first && last ? from + snapped(context, *last - *first, step, fine) * axis : from;
  }
  const glm::dvec3 normal = free ? view_.towards_eye : axis;
  const auto first = view_.in_plane(begin, from, normal), last = view_.in_plane(end, from, normal);
  if (!first || !last) return from;
  const glm::dvec3 by = *last - *first;
  const double length = glm::length(by);
  return length > 0 ? from + by * (snapped(context, length, step, fine) / length) : from;
}

void begin_tool(Context& context, std::unique_ptr<TransformTool> tool) {
  context.interaction->modal_wrap = PointerWrap(tool->view().place.rect, context.ui->look.px(2));
  context.interaction->modal = std::move(tool);
}

}  // namespace limber::editor
