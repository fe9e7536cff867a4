// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/tools/pose_tools.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "core/pose/inverse_kinematics.h"
#include "editor/posing.h"

namespace limber::editor {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPrecise = 0.1;                  // of the pointer's way, with Shift
constexpr double kSnapDegrees = 5, kSnapFine = 1;  // with Ctrl, with Ctrl and Shift
constexpr double kSnapMillimetres = 5, kSnapFineMillimetres = 1;
constexpr double kTrackballPerPixel = 0.01;       // radians
constexpr int kDigits = 9;

// Digits, a sign and a point, as they are typed.
class TypedNumber {
 public:
  // Whether the key is a part of a number.
  bool key(Key key) {
    if (const char digit = digit_of(key)) {
      if (std::ssize(text_) < kDigits) text_ += digit;
    } else if ((key == Key::Period || key == Key::NumPeriod || key == Key::Comma)) {
      if (text_.find('.') == std::string::npos) text_ += '.';
    } else if (key == Key::Minus || key == Key::NumMinus) {
      negative_ = !negative_;
      typed_ = true;
    } else if (key == Key::Backspace) {
      if (text_.empty()) typed_ = negative_ = false;
      else text_.pop_back();
      if (text_.empty() && !negative_) typed_ = false;
      return true;
    } else {
      return false;
    }
    typed_ = true;
    return true;
  }
  bool typed() const { return typed_; }
  double value() const { return (negative_ ? -1 : 1) * std::strtod(text_.c_str(), nullptr); }
  std::string text() const { return (negative_ ? "-" : "") + text_; }

 private:
  static char digit_of(Key key) {
    if (key >= Key::Digit0 && key <= Key::Digit9) return static_cast<char>('0' + (static_cast<int>(key) - static_cast<int>(Key::Digit0)));
    if (key >= Key::Num0 && key <= Key::Num9) return static_cast<char>('0' + (static_cast<int>(key) - static_cast<int>(Key::Num0)));
    return 0;
  }

  std::string text_;
  bool negative_ = false, typed_ = false;
};

int axis_of_key(Key key) { return key == Key::X ? 0 : key == Key::Y ? 1 : key == Key::Z ? 2 : -1; }

std::string text_of_number(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// What turning and dragging share: the pose before, the lock, the number, confirming and dropping.
class PoseTool : public Modal {
 public:
  PoseTool(Editor& editor, AxisLock lock, std::optional<MouseButton> held)
      : armature_(editor.document().armature), before_(pose_of(editor.document())), lock_(lock), held_(held), pointer_(editor.input.pointer) {
    const Rect* place = editor.layout.place_of(ViewId::Body);
    rect_ = place ? *place : Rect{};
  }

  bool moved(Editor& editor, const glm::vec2& pixels) override {
    const glm::dvec2 from = pointer_;
    pointer_ += glm::dvec2(pixels) * (editor.input.down(Key::Shift) ? kPrecise : 1.0);
    follow(editor, from, pointer_);
    show(editor);
    return true;
  }

  bool button(Editor& editor, const ButtonChanged& event) override {
    if (held_) {
      if (event.button == *held_ && !event.down) return confirm(editor);
      if (event.down && event.button == MouseButton::Right) return drop(editor);
      return true;
    }
    if (!event.down || event.button == MouseButton::Middle) return true;
    return event.button == MouseButton::Left ? confirm(editor) : drop(editor);
  }

  bool key(Editor& editor, const KeyChanged& event) override {
    if (!event.down) {
      if (event.key == Key::Ctrl || event.key == Key::Shift) show(editor);
      return true;
    }
    if (event.key == Key::Escape) return drop(editor);
    if (event.key == Key::Return || event.key == Key::NumEnter || event.key == Key::Space) return confirm(editor);
    if (const int axis = axis_of_key(event.key); axis >= 0) {
      // The world's, the bone's own, none.
      if (lock_.axis != axis) lock_ = {axis, false};
      else if (!lock_.local) lock_.local = true;
      else lock_ = {};
      locked(editor);
    } else if (!number_.key(event.key) && !own_key(event.key)) {
      return true;
    }
    show(editor);
    return true;
  }

  void cancel(Editor& editor) override { drop_shown_pose(editor); }

 protected:
  virtual void follow(Editor& editor, const glm::dvec2& from, const glm::dvec2& to) = 0;
  virtual Pose pose(Editor& editor) = 0;
  virtual std::string label() const = 0;
  virtual void locked(Editor&) {}
  virtual bool own_key(Key) { return false; }

  void show(Editor& editor) { show_pose(editor, pose(editor)); }

  bool confirm(Editor& editor) {
    commit_pose(editor, label(), pose(editor));
    return false;
  }
  bool drop(Editor& editor) {
    cancel(editor);
    return false;
  }

  double snapped(const Editor& editor, double value, double step, double fine) const {
    if (!editor.input.down(Key::Ctrl)) return value;
    const double grid = editor.input.down(Key::Shift) ? fine : step;
    return std::round(value / grid) * grid;
  }

  // Of the lock, in the world; zero where there is none.
  glm::dvec3 lock_axis(int bone) const {
    if (lock_.axis < 0) return glm::dvec3(0);
    if (lock_.local) return posed_axes(*armature_, before_, bone)[lock_.axis];
    return {lock_.axis == 0, lock_.axis == 1, lock_.axis == 2};
  }

  std::string lock_text() const {
    if (lock_.axis < 0) return "";
    return std::string(lock_.local ? " about local " : " about world ") + "XYZ"[lock_.axis];
  }

  std::vector<KeyHint> shared_hints() const {
    return {{{"X", "Y", "Z"}, "Lock, again: local"}, {{"0-9"}, "Type"}, {{"Ctrl"}, "Snap"}, {{"Shift"}, "Slowly"}, {{"Enter"}, "Keep"}, {{"Esc"}, "Back"}};
  }

  std::shared_ptr<const Armature> armature_;
  const Pose before_;
  AxisLock lock_;
  std::optional<MouseButton> held_;
  TypedNumber number_;
  glm::dvec2 pointer_;  // of the window, as if nothing stopped or slowed it
  Rect rect_;
};

class Turning final : public PoseTool {
 public:
  Turning(Editor& editor, const AxisLock& lock, bool trackball, std::optional<MouseButton> held)
      : PoseTool(editor, lock, held), bones_(topmost(*armature_, chosen_bones(editor))), trackball_(trackball) {
    active_ = editor.selection.bone.value_or(bones_.front());
    const glm::dvec3 pivot = posed_from_rest(*armature_, before_)[active_] * armature_->bones[active_].head;
    glm::dvec2 seen;
    const render::Camera& camera = editor.views->body.camera;
    if (render::project(camera, pivot, glm::ivec2(rect_.size()), seen)) centre_ = glm::dvec2(rect_.low) + seen;
    towards_eye_ = camera.world_from_view * glm::dvec3(0, 0, 1);
    right_ = camera.world_from_view * glm::dvec3(1, 0, 0);
    up_ = camera.world_from_view * glm::dvec3(0, 1, 0);
  }

  std::string title() const override {
    if (trackball_ && !number_.typed()) return "Trackball";
    return "Rotate " + (number_.typed() ? number_.text() : text_of_number("%.1f", shown_)) + "\u00b0" + lock_text();
  }

  std::vector<KeyHint> hints(const Editor&) const override {
    auto hints = shared_hints();
    hints.insert(hints.begin() + 1, {{"R"}, "Trackball"});
    return hints;
  }

 private:
  void follow(Editor&, const glm::dvec2& from, const glm::dvec2& to) override {
    const glm::dvec2 a = from - centre_, b = to - centre_;
    // Counter-clockwise as seen: y of the window points down.
    swept_ += std::atan2(a.y * b.x - a.x * b.y, glm::dot(a, b));
    rolled_ += glm::dvec2(to - from) * kTrackballPerPixel;
  }

  bool own_key(Key key) override {
    if (key != Key::R) return false;
    trackball_ = !trackball_;
    if (trackball_) lock_ = {};
    return true;
  }

  void locked(Editor&) override { trackball_ = false; }

  glm::dquat turn(Editor& editor) {
    if (trackball_ && !number_.typed()) return glm::angleAxis(rolled_.x, up_) * glm::angleAxis(rolled_.y, right_);
    glm::dvec3 axis = lock_axis(active_);
    double degrees = swept_ * 180 / kPi;
    if (axis == glm::dvec3(0)) axis = towards_eye_;
    // The pointer goes round the way it sees the axis.
    else if (glm::dot(axis, towards_eye_) < 0) degrees = -degrees;
    shown_ = number_.typed() ? number_.value() : snapped(editor, degrees, kSnapDegrees, kSnapFine);
    return glm::angleAxis(shown_ * kPi / 180, axis);
  }

  Pose pose(Editor& editor) override {
    const glm::dquat world = turn(editor);
    const auto posed = posed_from_rest(*armature_, before_);
    Pose next = before_;
    for (int bone : bones_) {
      const int parent = armature_->bones[bone].parent;
      const glm::dquat above = parent < 0 ? glm::dquat(1, 0, 0, 0) : posed[parent].rotation;
      next.rotation[bone] = glm::normalize(glm::conjugate(above) * world * above * before_.rotation[bone]);
    }
    return limited(editor, std::move(next), bones_);
  }

  std::string label() const override {
    return bones_.size() == 1 ? "Rotate " + armature_->bones[bones_[0]].name : "Rotate " + std::to_string(bones_.size()) + " bones";
  }

  std::vector<int> bones_;
  int active_ = 0;
  bool trackball_;
  glm::dvec2 centre_{0}, rolled_{0};
  glm::dvec3 towards_eye_{0, 0, 1}, right_{1, 0, 0}, up_{0, 1, 0};
  double swept_ = 0;  // radians
  double shown_ = 0;  // degrees
};

class Dragging final : public PoseTool {
 public:
  Dragging(Editor& editor, std::optional<MouseButton> held) : PoseTool(editor, {}, held), bone_(editor.selection.bone.value_or(0)) {
    const Bone& bone = armature_->bones[bone_];
    is_root_ = bone.parent < 0;
    const RigidTransform posed = posed_from_rest(*armature_, before_)[bone_];
    from_ = target_ = posed * (is_root_ ? bone.head : bone.tail);
    chain_ = limb_of(bone_);
  }

  bool wheel(Editor& editor, float steps) override {
    chain_ = std::clamp(chain_ + (steps > 0 ? 1 : -1), 1, depth_of(bone_));
    show(editor);
    return true;
  }

  std::string title() const override {
    std::string text = is_root_ ? "Move body" : "Reach, " + std::to_string(chain_) + (chain_ == 1 ? " bone" : " bones");
    if (lock_.axis >= 0) text += std::string(" along ") + (lock_.local ? "local " : "world ") + "XYZ"[lock_.axis];
    text += ", " + (number_.typed() ? number_.text() : text_of_number("%.1f", glm::distance(target_, from_))) + " mm";
    if (!is_root_ && !reached_) text += text_of_number(", out of reach by %.1f mm", short_of_);
    return text;
  }

  std::vector<KeyHint> hints(const Editor&) const override {
    auto hints = shared_hints();
    if (!is_root_) hints.insert(hints.begin(), {{"Wheel"}, "Length of the chain"});
    return hints;
  }

 private:
  // Up to where the rig branches: an arm does not take the trunk along.
  int limb_of(int bone) const {
    int length = 1;
    for (int b = bone; armature_->bones[b].parent >= 0; ++length) {
      const int parent = armature_->bones[b].parent;
      const auto children = std::count_if(armature_->bones.begin(), armature_->bones.end(), [&](const Bone& other) { return other.parent == parent; });
      if (children > 1) break;
      b = parent;
    }
    return length;
  }

  int depth_of(int bone) const {
    int depth = 1;
    while ((bone = armature_->bones[bone].parent) >= 0) ++depth;
    return depth;
  }

  void follow(Editor&, const glm::dvec2&, const glm::dvec2&) override {}

  // Under the pointer, in the plane through the start that faces the view; or where the lock's line is nearest to that.
  glm::dvec3 wanted(Editor& editor) const {
    const render::Camera& camera = editor.views->body.camera;
    const glm::ivec2 size(rect_.size());
    const glm::dvec3 axis = lock_axis(bone_);
    if (number_.typed()) return from_ + number_.value() * (axis == glm::dvec3(0) ? camera.world_from_view * glm::dvec3(1, 0, 0) : axis);
    glm::dvec2 seen;
    if (!render::project(camera, from_, size, seen)) return from_;
    const render::Ray ray = render::ray_through(camera, seen + (pointer_ - start_), size);
    const glm::dvec3 facing = camera.world_from_view * glm::dvec3(0, 0, 1);
    if (axis == glm::dvec3(0)) {
      const double along = glm::dot(from_ - ray.origin, facing) / glm::dot(ray.direction, facing);
      const glm::dvec3 by = ray.origin + along * ray.direction - from_;
      const double length = glm::length(by), snapped_length = snapped(editor, length, kSnapMillimetres, kSnapFineMillimetres);
      return length > 0 ? from_ + by * (snapped_length / length) : from_;
    }
    // The point of the line nearest to the ray.
    const glm::dvec3 off = from_ - ray.origin;
    const double b = glm::dot(axis, ray.direction), d = glm::dot(axis, off), e = glm::dot(ray.direction, off), denominator = 1 - b * b;
    if (denominator < 1e-6) return from_;
    return from_ + snapped(editor, (b * e - d) / denominator, kSnapMillimetres, kSnapFineMillimetres) * axis;
  }

  Pose pose(Editor& editor) override {
    target_ = wanted(editor);
    if (is_root_) {
      Pose next = before_;
      next.root_translation += target_ - from_;
      return next;
    }
    ReachSettings settings;
    settings.keep_limits = editor.posing.keep_limits;
    // From where the drag has come, so that the limb does not leap.
    const Reach found = reach(*armature_, shown_pose(editor), {{.bone = bone_, .target = target_, .chain = chain_}}, settings);
    reached_ = found.reached;
    short_of_ = found.distance;
    return found.pose;
  }

  std::string label() const override { return is_root_ ? "Move body" : "Reach with " + armature_->bones[bone_].name; }

  int bone_, chain_ = 1;
  bool is_root_ = false, reached_ = true;
  glm::dvec2 start_ = pointer_;
  glm::dvec3 from_{0}, target_{0};
  double short_of_ = 0;
};

}  // namespace

std::unique_ptr<Modal> begin_turning(Editor& editor, const AxisLock& lock, bool trackball, std::optional<MouseButton> held) {
  return std::make_unique<Turning>(editor, lock, trackball, held);
}

std::unique_ptr<Modal> begin_dragging(Editor& editor, std::optional<MouseButton> held) { return std::make_unique<Dragging>(editor, held); }

}  // namespace limber::editor
