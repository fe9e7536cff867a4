// SPDX-License-Identifier: AGPL-3.0-or-later
// Bones turned about their heads.
#include <cmath>
#include <numbers>

#include "core/rig/joint_reading.h"
#include "editor/gizmo_painter.h"
#include "editor/posing.h"
#include "editor/tools/pose_tools.h"

namespace limber::editor {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSnapDegrees = 5, kSnapFine = 1;  // with Ctrl, with Ctrl and Shift
constexpr double kTrackballPerPixel = 0.01;        // radians, at scale 1
constexpr double kNearLimit = 5;                   // degrees, from where an end of a joint's range is warned of
constexpr double kRing = 86, kLimitArc = 96;       // pixels

class Turning final : public TransformTool {
 public:
  Turning(Editor& editor, const Grip& grip)
      : TransformTool(editor, grip), armature_(editor.document().armature), before_(pose_of(editor.document())), bones_(topmost(*armature_, chosen_bones(editor))),
        active_(editor.selection.bone.value_or(bones_.front())), trackball_(grip.trackball), on_ring_(grip.held && !grip.trackball), scale_(editor.look.scale) {
    const auto posed = posed_from_rest(*armature_, before_);
    pivot_ = posed[active_] * armature_->bones[active_].head;
    if (const int parent = armature_->bones[active_].parent; parent >= 0) above_ = posed[parent].rotation;
    centre_ = view_.pixel_of(pivot_).value_or(pointer_);
    begin_about(axis());
  }

  std::string title() const override {
    if (trackball_ && !number_.typed()) return "Trackball";
    return "Rotate " + (number_.typed() ? number_.text() : text_of_number("%.1f", shown_)) + "\u00b0" + lock_text("about");
  }

  std::vector<KeyHint> hints(const Editor&) const override {
    auto hints = shared_hints();
    hints.insert(hints.begin() + 1, {{"R"}, "Trackball"});
    return hints;
  }

  void cancel(Editor& editor) override { drop_shown_pose(editor); }

  void draw(Editor& editor, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const GizmoPainter painter(editor, view_);
    if (trackball_ && !number_.typed()) return painter.read_out(pivot_, text_of_number("%.1f\u00b0", turned_), "trackball", limit_text(editor), editor.look.theme.view_text2);
    const Theme& theme = editor.look.theme;
    const double by = shown_ * kPi / 180;
    draw_limit(editor, painter);
    if (on_ring_ && lock_.axis >= 0)
      for (const int other : {(lock_.axis + 1) % 3, (lock_.axis + 2) % 3})
        painter.ring(ring_of(view_, scale_, pivot_, axes(lock_.space)[other], kRing), with_alpha(theme.axis[other], 0.3f), 2.5f, GizmoPainter::Part::Front);
    painter.sector(ring_, start_angle_, by, with_alpha(theme.select, 0.22f));
    painter.ring(ring_, kGizmoActive, 3.5f, GizmoPainter::Part::Whole);
    painter.line(pivot_, ring_.at(start_angle_), kGizmoActive, 1, true);
    painter.line(pivot_, ring_.at(start_angle_ + by), kGizmoActive, 1.6f);
    painter.dot(ring_.at(start_angle_ + by), kGizmoActive, 0xFF1A1614, 6);
    const std::string number = (number_.typed() ? number_.text() : text_of_number("%+.1f", shown_)) + "\u00b0";
    painter.read_out(pivot_, number, lock_.axis < 0 ? "view" : lock_text("").substr(1), limit_text(editor), limit_colour(editor));
  }

 private:
  glm::dmat3 axes(Space space) const override { return axes_of(space, *armature_, before_, active_, view_); }

  glm::dvec3 axis() const {
    const glm::dvec3 locked = lock_axis();
    return locked == glm::dvec3(0) ? view_.towards_eye : locked;
  }
  // The pointer goes round the way it sees the axis.
  double facing() const { return glm::dot(axis(), view_.towards_eye) < 0 ? -1 : 1; }

  void begin_about(const glm::dvec3& axis) {
    ring_ = ring_of(view_, scale_, pivot_, axis, kRing);
    start_angle_ = ring_.angle_under(view_, start_).value_or(0);
    last_angle_ = ring_.angle_under(view_, pointer_);
  }

  void follow(Editor& editor, const glm::dvec2& from, const glm::dvec2& to) override {
    const glm::dvec2 a = from - centre_, b = to - centre_;
    // Counter-clockwise as seen: y of the window points down.
    swept_seen_ += std::atan2(a.y * b.x - a.x * b.y, glm::dot(a, b));
    rolled_ += glm::dvec2(to - from) * (kTrackballPerPixel / editor.look.scale);
    if (const auto angle = ring_.angle_under(view_, to)) {
      if (last_angle_) swept_ring_ += std::remainder(*angle - *last_angle_, 2 * kPi);
      last_angle_ = angle;
    }
  }

  bool own_key(Editor&, Key key) override {
    if (key != Key::R) return false;
    trackball_ = !trackball_;
    if (trackball_) lock_ = {};
    return true;
  }

  void locked(Editor&) override {
    trackball_ = on_ring_ = false;
    begin_about(axis());
  }

  glm::dquat turn(Editor& editor) {
    if (trackball_ && !number_.typed()) {
      const glm::dquat turn = glm::angleAxis(rolled_.x, view_.up) * glm::angleAxis(rolled_.y, view_.right);
      turned_ = glm::degrees(glm::angle(turn.w < 0 ? -turn : turn));
      return turn;
    }
    const double degrees = glm::degrees(on_ring_ ? swept_ring_ : swept_seen_ * facing());
    shown_ = number_.typed() ? number_.value() : snapped(editor, degrees, kSnapDegrees, kSnapFine);
    return glm::angleAxis(glm::radians(shown_), axis());
  }

  Pose pose(Editor& editor) {
    const glm::dquat world = turn(editor);
    const auto posed = posed_from_rest(*armature_, before_);
    Pose next = before_;
    for (int bone : bones_) {
      const int parent = armature_->bones[bone].parent;
      const glm::dquat above = parent < 0 ? glm::dquat(1, 0, 0, 0) : posed[parent].rotation;
      next.rotation[bone] = glm::normalize(glm::conjugate(above) * world * above * before_.rotation[bone]);
    }
    return limited(editor, mirrored_too(editor, before_, std::move(next)), bones_);
  }

  void show(Editor& editor) override { show_pose(editor, pose(editor)); }
  void keep(Editor& editor) override {
    const std::string what = bones_.size() == 1 ? armature_->bones[bones_[0]].name : std::to_string(bones_.size()) + " bones";
    commit_pose(editor, "Rotate " + what, pose(editor));
  }

  // Of the active joint, before the turn and as it is shown.
  std::optional<JointReading> reading(const Pose& pose) const {
    return read_joint(armature_->bones[active_], pose.rotation[active_], glm::conjugate(above_) * axis());
  }

  // What the turn asks for, in the joint's own angle.
  double asked(const JointReading& start) const { return start.angle + start.sense * glm::radians(shown_); }

  Colour limit_colour(const Editor& editor) const {
    const auto start = reading(before_);
    if (!start) return editor.look.theme.view_text2;
    const double angle = asked(*start), near = glm::radians(kNearLimit);
    const Theme& theme = editor.look.theme;
    if (angle < start->minimum - 1e-6 || angle > start->maximum + 1e-6) return theme.error;
    return angle < start->minimum + near || angle > start->maximum - near ? theme.warn : theme.ok;
  }

  std::string limit_text(const Editor& editor) const {
    const auto now = reading(shown_pose(editor));
    if (!now) return armature_->bones[active_].limits.type == JointLimits::Type::Free ? "No limits" : "Across the hinge";
    if (now->kind == JointReading::Kind::Fixed) return "Fixed joint";
    const double end = glm::degrees(now->angle >= 0 ? now->maximum : now->minimum);
    return std::string(name_of(now->kind)) + text_of_number(" %.1f\u00b0", glm::degrees(now->angle)) + text_of_number(" of %.0f\u00b0", end);
  }

  void draw_limit(Editor& editor, const GizmoPainter& painter) const {
    const auto start = reading(before_);
    if (!start || start->maximum - start->minimum <= 0 || start->maximum - start->minimum >= 2 * kPi) return;
    Ring arc = ring_;
    arc.radius *= kLimitArc / kRing;
    painter.arc(arc, start_angle_ + start->sense * (start->minimum - start->angle), start_angle_ + start->sense * (start->maximum - start->angle), limit_colour(editor), 3);
  }

  std::shared_ptr<const Armature> armature_;
  const Pose before_;
  std::vector<int> bones_;
  int active_ = 0;
  bool trackball_, on_ring_;  // the pointer's way is measured round the ring, not round the joint as it is seen
  float scale_;
  glm::dvec3 pivot_{0};
  glm::dquat above_{1, 0, 0, 0};  // the active bone's parent
  glm::dvec2 centre_{0}, rolled_{0};
  Ring ring_;
  double start_angle_ = 0;
  std::optional<double> last_angle_;
  double swept_seen_ = 0, swept_ring_ = 0;  // radians
  double shown_ = 0, turned_ = 0;           // degrees
};

}  // namespace

std::unique_ptr<TransformTool> begin_turning(Editor& editor, const Grip& grip) { return std::make_unique<Turning>(editor, grip); }

}  // namespace limber::editor
