// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal tool that turns the selected bones about their heads.
#include <cmath>
#include <numbers>

#include <glm/gtx/quaternion.hpp>

#include "core/rig/anatomical_position.h"
#include "core/rig/joint_angle.h"
#include "editor/context/context.h"
#include "editor/context/pose_editing.h"
#include "editor/context/selection.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_tools.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/viewport/angle_drag.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr double kPi = std::numbers::pi;

// Returns the axis of the bone's hinge in the pose, world coordinates; nothing when the joint is no hinge or while
// "Keep to joint limits" is off.
std::optional<glm::dvec3> hinge_of(const PoseEditing& posing, const Armature& armature, const Pose& pose, int bone) {
  const Bone& b = armature.bones[bone];
  if (!posing.keep_limits || b.limits.type != JointLimits::Type::Hinge) return std::nullopt;
  return b.parent < 0 ? b.limits.axis : posed_from_rest(armature, pose)[b.parent].rotation * b.limits.axis;
}

// Returns the index (0 to 2) of the axis that is most nearly parallel to a direction, in either sense.
int nearest_axis(const glm::dmat3& axes, const glm::dvec3& direction) {
  int nearest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(glm::dot(axes[axis], direction)) > std::abs(glm::dot(axes[nearest], direction))) nearest = axis;
  return nearest;
}
constexpr double kSnapDegrees = 5, kSnapFine = 1;  // snapping steps in degrees: Ctrl, Ctrl + Shift
constexpr double kTrackballPerPixel = 0.01;        // trackball: turn per pixel of pointer motion at scale 1, radians
constexpr double kNearLimit = 5;  // angles closer than this to a limit have the warning colour, degrees
// A bone counts as stopped by a limit if its rotation is farther than this from the asked one, degrees.
constexpr double kHeld = 0.1;
constexpr double kLimitArc = 96;  // radius of the arc that shows the limits, pixels at scale 1

class Turning final : public TransformTool {
 public:
  Turning(Context& context, const Grip& grip)
      : TransformTool(context, grip),
        armature_(context.document().armature),
        before_(pose_of(context.document())),
        bones_(topmost(*armature_, chosen_bones(context))),
        active_(context.selection->bone.value_or(bones_.front())),
        trackball_(grip.trackball),
        by_ring_(grip.held && !grip.trackball && grip.lock.axis >= 0),
        scale_(context.ui->look.scale),
        drag_(view_, scale_, pivot_of_active(), grip.held && !grip.trackball),
        at_rest_(turn_at_rest(*armature_, active_)) {
    if (by_ring_) ring_axes_ = axes_of_rings(context.posing, lock_.space, *armature_, before_, active_, view_);
    on_hinge_ = by_ring_ && hinge_of(context.posing, *armature_, before_, active_) &&
                nearest_axis(ring_axes_, *hinge_of(context.posing, *armature_, before_, active_)) == lock_.axis;
    if (const int parent = armature_->bones[active_].parent; parent >= 0)
      above_ = posed_from_rest(*armature_, before_)[parent].rotation;
    drag_.about(axis(), start_, pointer_);
  }

  std::string title() const override {
    if (trackball_ && !number_.typed()) return "Trackball";
    return "Rotate " + (number_.typed() ? number_.text() : text_of_number("%.1f", shown_)) + "\u00b0" + about();
  }

  std::vector<KeyHint> hints(const Context&) const override {
    auto hints = shared_hints();
    hints.insert(hints.begin() + 1, {{"R"}, "Trackball"});
    if (held_) hints.insert(hints.begin(), {{}, held_text()});
    return hints;
  }

  void cancel(Context& context) override { drop_shown_pose(context); }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const GizmoPainter painter(context, view_);
    if (trackball_ && !number_.typed())
      return painter.read_out(pivot(), text_of_number("%.1f\u00b0", turned_), "trackball", limit_text(context),
                              context.ui->look.theme.view_text2);
    const Theme& theme = context.ui->look.theme;
    draw_limit(context, painter);
    if (drag_.on_ring() && lock_.axis >= 0)
      for (const int other : {(lock_.axis + 1) % 3, (lock_.axis + 2) % 3})
        painter.ring(ring_of(view_, scale_, pivot(), axes(lock_.space)[other], AngleDrag::kRing),
                     with_alpha(theme.axis[other], 0.3f), 2.5f, GizmoPainter::Part::Front);
    drag_.draw(painter, theme, shown_);
    const std::string number = (number_.typed() ? number_.text() : text_of_number("%+.1f", shown_)) + "\u00b0";
    painter.read_out(pivot(), number,
                     lock_.axis < 0          ? "view"
                     : on_hinge_ && by_ring_ ? "hinge"
                                             : lock_text("").substr(1),
                     limit_text(context), limit_colour(context));
  }

 private:
  glm::dmat3 axes(Space space) const override {
    return by_ring_ ? ring_axes_ : axes_of(space, *armature_, before_, active_, view_);
  }
  std::string about() const { return on_hinge_ && by_ring_ ? " about the hinge" : lock_text("about"); }

  glm::dvec3 axis() const {
    const glm::dvec3 locked = lock_axis();
    return locked == glm::dvec3(0) ? view_.towards_eye : locked;
  }
  const glm::dvec3& pivot() const { return drag_.ring().centre; }
  glm::dvec3 pivot_of_active() const {
    return posed_from_rest(*armature_, before_)[active_] * armature_->bones[active_].head;
  }

  void follow(Context& context, const glm::dvec2& from, const glm::dvec2& to) override {
    drag_.follow(from, to);
    rolled_ += glm::dvec2(to - from) * (kTrackballPerPixel / context.ui->look.scale);
  }

  bool own_key(Context&, Key key) override {
    if (key != Key::R) return false;
    trackball_ = !trackball_;
    if (trackball_) lock_ = {};
    return true;
  }

  void locked(Context&) override {
    trackball_ = by_ring_ = false;
    drag_.leave_ring();
    drag_.about(axis(), start_, pointer_);
  }

  glm::dquat turn(Context& context) {
    if (trackball_ && !number_.typed()) {
      const glm::dquat turn = glm::angleAxis(rolled_.x, view_.up) * glm::angleAxis(rolled_.y, view_.right);
      turned_ = glm::degrees(glm::angle(turn.w < 0 ? -turn : turn));
      return turn;
    }
    shown_ = number_.typed() ? number_.value() : snapped(context, drag_.degrees(), kSnapDegrees, kSnapFine);
    return glm::angleAxis(glm::radians(shown_), axis());
  }

  Pose pose(Context& context) {
    const glm::dquat world = turn(context);
    const auto posed = posed_from_rest(*armature_, before_);
    Pose next = before_;
    for (int bone : bones_) {
      const int parent = armature_->bones[bone].parent;
      const glm::dquat above = parent < 0 ? glm::dquat(1, 0, 0, 0) : posed[parent].rotation;
      next.rotation[bone] = glm::normalize(glm::conjugate(above) * world * above * before_.rotation[bone]);
    }
    const Pose asked = next;
    next = mirrored_too(context, before_, std::move(next));
    mirrored_ = changed_bones(asked, next);
    next = limited(context, std::move(next), bones_);
    held_.reset();
    for (int bone : bones_) {
      if (held_ != active_ && is_held(bone, asked, next)) held_ = bone;
    }
    return next;
  }

  // Returns whether a joint limit keeps the bone from the rotation that the user asks for. A hinge that the user turns
  // about another axis than the hinge's own axis never reaches the asked rotation. Therefore a hinge counts as stopped
  // only when it does not turn at all or has reached an end of its range.
  //   asked  the pose that the user asks for, before joint limits are applied
  //   kept   the pose after joint limits are applied
  bool is_held(int index, const Pose& asked, const Pose& kept) const {
    const auto apart = [&](const glm::dquat& a, const glm::dquat& b) {
      return glm::degrees(2 * std::acos(std::min(1.0, std::abs(glm::dot(a, b))))) > kHeld;
    };
    if (!apart(asked.rotation[index], kept.rotation[index])) return false;
    const JointLimits& limits = armature_->bones[index].limits;
    if (limits.type != JointLimits::Type::Hinge || !apart(kept.rotation[index], before_.rotation[index])) return true;
    const double angle = swing_twist(kept.rotation[index], limits.axis).twist;
    return std::min(std::abs(angle - limits.minimum), std::abs(angle - limits.maximum)) < 1e-6;
  }

  // Returns the text that says which joint limit stops the bone `held_`.
  std::string held_text() const {
    const Bone& bone = armature_->bones[*held_];
    const auto reading = *held_ == active_ ? this->reading(before_) : std::nullopt;
    if (*held_ == active_ && !reading && bone.limits.type == JointLimits::Type::Hinge)
      return bone.name + " only turns about its hinge";
    return "At the joint limit of " + bone.name +
           (reading && reading->kind != JointReading::Kind::Fixed ? " (" + range_text(*reading) + ")" : "");
  }

  std::vector<FormField> parameters() const override {
    if (trackball_ && !number_.typed())
      return {number_of("About vertical", "Angle about the view's vertical axis.", glm::degrees(rolled_.x), -360, 360,
                        "%.2f", "\u00b0"),
              number_of("About horizontal", "Angle about the view's horizontal axis.", glm::degrees(rolled_.y), -360,
                        360, "%.2f", "\u00b0")};
    std::vector<FormField> fields = fields_of_axis();
    fields.insert(fields.begin(), number_of("Angle", "Angle by which the bones turn about the axis.", shown_, -360, 360,
                                            "%.2f", "\u00b0"));
    return fields;
  }
  void set(const std::vector<FormField>& fields) override {
    if (fields.size() == 2) {
      rolled_ = glm::radians(glm::dvec2(fields[0].value, fields[1].value));
      return;
    }
    number_.set(fields[0].value);
    const AxisLock before = lock_;
    set_axis(fields, 1);
    if (lock_.axis != before.axis || lock_.space != before.space) by_ring_ = false;
  }

  void show(Context& context) override {
    const Pose next = pose(context);
    preview_pose(context, next, mirrored_);
  }
  void keep(Context& context) override {
    const std::string what =
        bones_.size() == 1 ? armature_->bones[bones_[0]].name : std::to_string(bones_.size()) + " bones";
    Pose next = pose(context);
    if (held_ && number_.typed()) context.messages->info(held_text());
    commit_pose(context, "Rotate " + what, std::move(next), mirrored_);
  }

  // Returns the active joint's angle and limits in a pose. Both are measured about the axis that the tool turns about.
  // Returns nothing when the joint has no limits about this axis.
  std::optional<JointReading> reading(const Pose& pose) const {
    return read_joint(armature_->bones[active_], pose.rotation[active_], glm::conjugate(above_) * axis(), at_rest_);
  }

  // Returns the angle that the active joint would have after this turn if it had no limits, radians.
  //   start  the joint's angle and limits before the turn
  double asked(const JointReading& start) const { return start.angle + start.sense * glm::radians(shown_); }

  Colour limit_colour(const Context& context) const {
    const auto start = reading(before_);
    if (!start) return context.ui->look.theme.view_text2;
    const double angle = asked(*start), near = glm::radians(kNearLimit);
    if (angle < start->minimum - 1e-6 || angle > start->maximum + 1e-6) return kViewError;
    return angle < start->minimum + near || angle > start->maximum - near ? kViewWarn : kViewOk;
  }

  std::string limit_text(const Context& context) const {
    const auto now = reading(shown_pose(context));
    if (!now)
      return armature_->bones[active_].limits.type == JointLimits::Type::Free ? "No limits" : "Not about the hinge";
    return text_of(*now);
  }

  void draw_limit(Context& context, const GizmoPainter& painter) const {
    const auto start = reading(before_);
    if (!start || start->maximum - start->minimum <= 0 || start->maximum - start->minimum >= 2 * kPi) return;
    Ring arc = drag_.ring();
    arc.radius *= kLimitArc / AngleDrag::kRing;
    painter.arc(arc, drag_.start() + start->sense * (start->minimum - start->angle),
                drag_.start() + start->sense * (start->maximum - start->angle), limit_colour(context), 3);
  }

  std::shared_ptr<const Armature> armature_;
  const Pose before_;
  std::vector<int> bones_, mirrored_;  // bones that the user turns; bones on the other side that X-mirror turns too
  int active_ = 0;
  bool trackball_;
  bool by_ring_, on_hinge_ = false;  // true if a ring is dragged; true if the ring's axis is the hinge's
  glm::dmat3 ring_axes_{1};
  float scale_;
  AngleDrag drag_;
  const glm::dvec3 at_rest_;       // rotation vector of the active joint from the anatomical position to rest, radians
  std::optional<int> held_;        // the bone that a joint limit stops (the active bone if several); none: no bone
  glm::dquat above_{1, 0, 0, 0};   // rotation of the active bone's parent from rest
  glm::dvec2 rolled_{0};           // trackball: turns about the view's up and right axes, radians
  double shown_ = 0, turned_ = 0;  // angle about the axis; total angle of the trackball, degrees
};

}  // namespace

glm::dmat3 axes_of_rings(const PoseEditing& posing, Space space, const Armature& armature, const Pose& pose, int bone,
                         const ViewProjection& view) {
  glm::dmat3 axes = axes_of(space, armature, pose, bone, view);
  const auto hinge = hinge_of(posing, armature, pose, bone);
  if (!hinge) return axes;
  const int nearest = nearest_axis(axes, *hinge);
  const glm::dvec3 along = glm::normalize(*hinge) * (glm::dot(axes[nearest], *hinge) < 0 ? -1.0 : 1.0);
  const glm::dquat turn = glm::rotation(glm::normalize(axes[nearest]), along);
  for (int axis = 0; axis < 3; ++axis) axes[axis] = turn * axes[axis];
  return axes;
}

std::unique_ptr<TransformTool> begin_turning(Context& context, const Grip& grip) {
  return std::make_unique<Turning>(context, grip);
}

}  // namespace limber::editor
