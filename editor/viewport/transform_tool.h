// SPDX-License-Identifier: AGPL-3.0-or-later
// The base class of the tools that move, rotate and scale. It handles what they share: the view that the tool works in,
// the lock to an axis or plane, the typed number, snapping, confirming and cancelling. A confirmed tool object is kept
// as long as the user may still adjust its numbers.
#pragma once

#include <memory>
#include <optional>

#include "editor/context/modal_tool.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/dialogs/form_field.h"
#include "editor/viewport/numeric_input.h"

namespace limber::editor {

struct Context;

// The axis of a coordinate space to which a transform tool is locked. The tool moves or scales along this axis, or
// turns about it. If `plane`, the tool moves or scales in the plane perpendicular to the axis.
struct AxisLock {
  int axis = -1;  // index of the axis: 0 x, 1 y, 2 z; -1: no lock
  Space space = Space::Global;
  bool plane = false;
};

// The options with which a transform tool starts.
struct Grip {
  AxisLock lock = {};
  // The mouse button that began a drag. Its release confirms the tool. If the pointer has not moved, the release counts
  // as a click and selects what lies under the pointer. No value: the tool was started in another way.
  std::optional<MouseButton> held = {};
  bool trackball = false;
};

class TransformTool : public Modal, public std::enable_shared_from_this<TransformTool> {
 public:
  TransformTool(Context& context, const Grip& grip);

  bool moved(Context& context, const glm::vec2& pixels) override;
  bool button(Context& context, const ButtonChanged& event) override;
  bool key(Context& context, const KeyChanged& event) override;

  const ViewProjection& view() const { return view_; }

 protected:
  // Handles a motion of the pointer between two pixel positions. While Shift is held, the motion passed is a tenth of
  // the pointer's real motion.
  virtual void follow(Context&, const glm::dvec2& /*from*/, const glm::dvec2& /*to*/) {}
  virtual void show(Context& context) = 0;
  virtual void keep(Context& context) = 0;
  virtual glm::dmat3 axes(Space space) const = 0;
  virtual void locked(Context&) {}  // called after the user has changed the axis lock
  virtual bool own_key(Context&, Key) { return false; }
  // parameters() returns the tool's numbers (distance, angle, factor, axis) as form fields. After the tool has ended,
  // the user can change these fields: set() then takes the new values, and keep() commits the changed result.
  virtual std::vector<FormField> parameters() const { return {}; }
  virtual void set(const std::vector<FormField>&) {}

  void lock_to_way(Context& context);
  bool confirm(Context& context);
  bool drop(Context& context);
  double snapped(const Context& context, double value, double step, double fine) const;
  // Returns the axis that the tool is locked to, as a unit vector in the world; the zero vector without a lock.
  glm::dvec3 lock_axis() const;
  std::string lock_text(const char* word) const;  // returns `word` and the locked axis as text: " about local X"
  std::vector<KeyHint> shared_hints() const;
  // Returns the position to which the pointer has dragged a point that was at `from`, along the locked axis or plane if
  // there is one. If snapping is on, the distance snaps to multiples of `step`, or of `fine` while Shift is held, mm;
  // 0: no snapping.
  glm::dvec3 dragged(const Context& context, const glm::dvec3& from, double step, double fine) const;

  // The first two functions convert a translation (`way`, world, mm) to form fields and back. The last two functions
  // convert the locked axis to form fields and back; `first` is the index of the axis's first field.
  std::vector<FormField> fields_of_way(const glm::dvec3& way) const;
  void set_way(const std::vector<FormField>& fields);
  std::vector<FormField> fields_of_axis() const;
  void set_axis(const std::vector<FormField>& fields, std::size_t first);

  ViewProjection view_;
  AxisLock lock_;
  std::optional<MouseButton> held_;
  TypedNumber number_;
  // Positions of the pointer now and at the start, pixels; motions with Shift count a tenth.
  glm::dvec2 pointer_, start_;
  double travelled_ = 0;           // largest distance of the pointer from start_, pixels
  std::optional<glm::dvec3> way_;  // translation typed in the form, replaces the pointer's; world, mm
};

// Returns the view that a tool works in: the view under the pointer, else the 3D view, else the first view.
ViewPlace place_of_tool(const Context& context);

// Makes the tool the editor's modal tool. A pointer that leaves the tool's view is moved to the opposite side of the
// view, so that drags have no end.
void begin_tool(Context& context, std::unique_ptr<TransformTool> tool);

std::string text_of_number(const char* format, double value);

}  // namespace limber::editor
