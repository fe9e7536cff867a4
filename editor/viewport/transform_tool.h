// SPDX-License-Identifier: AGPL-3.0-or-later
// What moving, turning and scaling share: the view they act in, the lock to an axis or plane, the number that is typed,
// snapping, confirming and dropping. A tool that was confirmed lives on while its numbers may still be adjusted.
#pragma once

#include <memory>
#include <optional>

#include "editor/context/editor.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/viewport/numeric_input.h"

namespace limber::editor {

// What a tool is held to: along or about an axis of a space, or in the plane across it.
struct AxisLock {
  int axis = -1;  // 0 .. 2; -1: none
  Space space = Space::Global;
  bool plane = false;
};

// How a tool begins.
struct Grip {
  AxisLock lock = {};
  std::optional<MouseButton> held =
      {};  // the button whose release ends it; a release in place picks what lies below instead
  bool trackball = false;
};

class TransformTool : public Modal, public std::enable_shared_from_this<TransformTool> {
 public:
  TransformTool(Editor& editor, const Grip& grip);

  bool moved(Editor& editor, const glm::vec2& pixels) override;
  bool button(Editor& editor, const ButtonChanged& event) override;
  bool key(Editor& editor, const KeyChanged& event) override;

  const ViewProjection& view() const { return view_; }

 protected:
  virtual void follow(Editor&, const glm::dvec2& /*from*/, const glm::dvec2& /*to*/) {}  // the pointer, slowed
  virtual void show(Editor& editor) = 0;
  virtual void keep(Editor& editor) = 0;
  virtual glm::dmat3 axes(Space space) const = 0;
  virtual void locked(Editor&) {}  // by a key
  virtual bool own_key(Editor&, Key) { return false; }
  // What it did, in numbers, and what it is to do: keep() follows.
  virtual std::vector<FormField> parameters() const { return {}; }
  virtual void set(const std::vector<FormField>&) {}

  void lock_to_way(Editor& editor);
  bool confirm(Editor& editor);
  bool drop(Editor& editor);
  double snapped(const Editor& editor, double value, double step, double fine) const;
  // Of the lock, in the world; zero where there is none.
  glm::dvec3 lock_axis() const;
  std::string lock_text(const char* word) const;  // " about local X"
  std::vector<KeyHint> shared_hints() const;
  // Where a point goes that the pointer takes along from `from`, held by the lock; `step`, `fine` in mm, 0 for none.
  glm::dvec3 dragged(const Editor& editor, const glm::dvec3& from, double step, double fine) const;

  // Of a way in the world, mm; and of the axis that is turned about or scaled along. The latter's begin at `first`.
  std::vector<FormField> fields_of_way(const glm::dvec3& way) const;
  void set_way(const std::vector<FormField>& fields);
  std::vector<FormField> fields_of_axis() const;
  void set_axis(const std::vector<FormField>& fields, std::size_t first);

  ViewProjection view_;
  AxisLock lock_;
  std::optional<MouseButton> held_;
  TypedNumber number_;
  glm::dvec2 pointer_, start_;     // of the window, as if nothing stopped or slowed it
  double travelled_ = 0;           // pixels, the furthest from the start
  std::optional<glm::dvec3> way_;  // mm, in place of the pointer's
};

// The view under the pointer, else the 3D view, else any.
ViewPlace place_of_tool(const Editor& editor);

// Takes the input; the pointer that leaves the tool's view comes in again at its other side.
void begin_tool(Editor& editor, std::unique_ptr<TransformTool> tool);

std::string text_of_number(const char* format, double value);

}  // namespace limber::editor
