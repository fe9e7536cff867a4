// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal tools that drag a joint or a pole while the limb follows by inverse kinematics. A pole is a point towards which
// the middle joint of a limb, such as the elbow, is bent.
#include <algorithm>
#include <cmath>

#include "core/rig/inverse_kinematics.h"
#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/layout.h"
#include "editor/context/pose_editing.h"
#include "editor/context/selection.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_tools.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr double kSnapMillimetres = 5, kSnapFineMillimetres = 1;
constexpr double kPinWeight = 10;  // IK weight of a pinned joint's target; the dragged joint's target has weight 1

class Dragging final : public TransformTool {
 public:
  Dragging(Context& context, const Grip& grip)
      : TransformTool(context, grip),
        armature_(context.document().armature),
        before_(pose_of(context.document())),
        bone_(context.selection->bone.value_or(0)) {
    const Bone& bone = armature_->bones[bone_];
    is_root_ = bone.parent < 0;
    const auto posed = posed_from_rest(*armature_, before_);
    from_ = target_ = posed[bone_] * (is_root_ ? bone.head : bone.tail);
    chain_ = context.transform_settings->auto_ik ? limb_of(*armature_, bone_) : 1;
    const Anchors& anchors = anchors_of(context.document());
    for (const std::string& name : anchors.pins)
      if (const auto pin = armature_->find(name); pin && *pin != bone_)
        pins_.push_back({.bone = *pin,
                         .target = posed[*pin] * armature_->bones[*pin].tail,
                         .chain = limb_of(*armature_, *pin),
                         .weight = kPinWeight});
    if (const auto pole = anchors.poles.find(bone.name); pole != anchors.poles.end()) pole_ = pole->second;
  }

  bool wheel(Context& context, float steps) override {
    chain_ = std::clamp(chain_ + (steps > 0 ? 1 : -1), 1, depth_of(bone_));
    show(context);
    return true;
  }

  std::string title() const override {
    std::string text = is_root_ ? "Move body" : "Reach, " + std::to_string(chain_) + (chain_ == 1 ? " bone" : " bones");
    text += lock_text("along") + ", " +
            (number_.typed() ? number_.text() : text_of_number("%.1f", glm::distance(target_, from_))) + " mm";
    if (!reached_) text += text_of_number(", out of reach by %.1f mm", short_of_);
    return text;
  }

  std::vector<KeyHint> hints(const Context&) const override {
    auto hints = shared_hints();
    if (!is_root_) hints.insert(hints.begin(), {{"Wheel"}, "Length of the chain"});
    return hints;
  }

  void cancel(Context& context) override { drop_shown_pose(context); }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const GizmoPainter painter(context, view_);
    const Theme& theme = context.ui->look.theme;
    const auto posed = posed_from_rest(*armature_, seen_pose(context));
    int bone = bone_;
    for (int i = 0; !is_root_ && i < chain_ && bone >= 0; ++i, bone = armature_->bones[bone].parent)
      painter.line(posed[bone] * armature_->bones[bone].head, posed[bone] * armature_->bones[bone].tail, kViewAccent,
                   2);
    if (lock_.axis >= 0 && !lock_.plane) {
      const double far = view_.millimetres_per_pixel(from_) * 2000;
      painter.line(from_ - far * lock_axis(), from_ + far * lock_axis(), with_alpha(theme.axis[lock_.axis], 0.6f), 1);
    }
    painter.line(from_, target_, theme.view_text2, 1, true);
    painter.diamond(target_, reached_ ? theme.select : kViewError, 12);
    const std::string number =
        (number_.typed() ? number_.text() : text_of_number("%.1f", glm::distance(target_, from_))) + " mm";
    const std::string words =
        is_root_ ? "The body" : std::to_string(chain_) + (chain_ == 1 ? " bone follows" : " bones follow");
    painter.read_out(target_, number, lock_.axis < 0 ? "" : lock_text("along").substr(1),
                     reached_ ? words : text_of_number("Out of reach by %.1f mm", short_of_),
                     reached_ ? theme.view_text2 : kViewError);
  }

 private:
  glm::dmat3 axes(Space space) const override { return axes_of(space, *armature_, before_, bone_, view_); }

  int depth_of(int bone) const {
    int depth = 1;
    while ((bone = armature_->bones[bone].parent) >= 0) ++depth;
    return depth;
  }

  Pose pose(Context& context) {
    target_ = dragged(context, from_, kSnapMillimetres, kSnapFineMillimetres);
    ReachSettings settings;
    settings.keep_limits = context.posing->keep_limits;
    // The IK solver starts from the shown pose, so that the limb does not jump from one drawn frame to the next.
    Pose start = shown_pose(context);
    std::vector<ReachGoal> goals = pins_;
    if (is_root_) {
      start.root_translation = before_.root_translation + target_ - from_;
      if (goals.empty()) return start;
    } else {
      goals.insert(goals.begin(), {.bone = bone_, .target = target_, .chain = chain_});
      settings.pole = pole_;
    }
    const Reach found = reach(*armature_, start, goals, settings);
    reached_ = found.reached;
    short_of_ = found.distance;
    const Pose next = mirrored_too(context, before_, found.pose);
    mirrored_ = changed_bones(found.pose, next);
    return next;
  }

  std::vector<FormField> parameters() const override {
    std::vector<FormField> fields = fields_of_way(target_ - from_);
    if (!is_root_)
      fields.push_back(
          number_of("Bones", "Number of bones that follow the dragged joint.", chain_, 1, depth_of(bone_), "%.0f"));
    return fields;
  }
  void set(const std::vector<FormField>& fields) override {
    set_way(fields);
    if (!is_root_) chain_ = static_cast<int>(std::round(fields[4].value));
  }

  void show(Context& context) override {
    const Pose next = pose(context);
    preview_pose(context, next, mirrored_);
  }
  void keep(Context& context) override {
    const Pose next = pose(context);
    commit_pose(context, is_root_ ? "Move body" : "Reach with " + armature_->bones[bone_].name, next, mirrored_);
  }

  std::shared_ptr<const Armature> armature_;
  const Pose before_;
  int bone_, chain_ = 1;
  bool is_root_ = false, reached_ = true;
  glm::dvec3 from_{0}, target_{0};
  std::vector<ReachGoal> pins_;
  std::vector<int> mirrored_;  // the bones on the other side of the body that X-mirror turns too
  std::optional<glm::dvec3> pole_;
  double short_of_ = 0;
};

// Modal tool that drags the pole of the active bone's limb. The limb turns so that its middle joint points towards the
// pole, while the limb's end keeps its position. With X-mirror on, the pole of the other side's limb moves as a mirror
// image, if that limb has a pole.
class DraggingPole final : public TransformTool {
 public:
  DraggingPole(Context& context, const Grip& grip)
      : TransformTool(context, grip),
        armature_(context.document().armature),
        before_(pose_of(context.document())),
        bone_(*context.selection->bone),
        from_(anchors_of(context.document()).poles.at(armature_->bones[bone_].name)) {
    const int other = mirror_pairs(*armature_)[bone_];
    if (context.transform_settings->x_mirror && other != bone_ &&
        anchors_of(context.document()).poles.contains(armature_->bones[other].name))
      other_ = other;
  }

  std::string title() const override { return "Turn limb to pole" + lock_text("along"); }
  std::vector<KeyHint> hints(const Context&) const override { return shared_hints(); }
  void cancel(Context& context) override {
    context.transform_settings->shown_pole = {};
    drop_shown_pose(context);
  }

 private:
  glm::dmat3 axes(Space space) const override { return axes_of(space, *armature_, before_, bone_, view_); }

  Pose pose(Context& context) {
    to_ = dragged(context, from_, kSnapMillimetres, kSnapFineMillimetres);
    const Pose one = turned(context, before_, bone_, to_);
    return other_ ? turned(context, one, *other_, mirrored()) : one;
  }

  Pose turned(const Context& context, const Pose& pose, int bone, const glm::dvec3& pole) const {
    const glm::dvec3 end = posed_from_rest(*armature_, before_)[bone] * armature_->bones[bone].tail;
    return reach(*armature_, pose, {{.bone = bone, .target = end, .chain = limb_of(*armature_, bone)}},
                 {.keep_limits = context.posing->keep_limits, .pole = pole})
        .pose;
  }

  // Returns the pole's position mirrored at the plane between the left and the right side of the body, mm. The plane
  // moves with the root bone.
  glm::dvec3 mirrored() const {
    int root = bone_;
    while (armature_->bones[root].parent >= 0) root = armature_->bones[root].parent;
    const RigidTransform posed = posed_from_rest(*armature_, before_)[root];
    return posed * mirror_plane(*armature_).place(inverse(posed) * to_);
  }

  std::vector<FormField> parameters() const override { return fields_of_way(to_ - from_); }
  void set(const std::vector<FormField>& fields) override { set_way(fields); }

  void show(Context& context) override {
    preview_pose(context, pose(context));
    context.transform_settings->shown_pole = {armature_->bones[bone_].name, to_};
  }
  void keep(Context& context) override {
    Pose turned = pose(context);
    Document next = context.document();
    Anchors anchors = anchors_of(next);
    anchors.poles[armature_->bones[bone_].name] = to_;
    if (other_) anchors.poles[armature_->bones[*other_].name] = mirrored();
    if (anchors != anchors_of(next)) next.anchors = std::make_shared<const Anchors>(std::move(anchors));
    context.transform_settings->shown_pole = {};
    commit_pose(context, "Turn limb to pole", std::move(turned), std::move(next));
  }

  std::shared_ptr<const Armature> armature_;
  const Pose before_;
  int bone_;
  std::optional<int> other_;
  glm::dvec3 from_, to_ = from_;
};

}  // namespace

std::unique_ptr<TransformTool> begin_dragging_pole(Context& context, const Grip& grip) {
  return std::make_unique<DraggingPole>(context, grip);
}

std::unique_ptr<TransformTool> begin_dragging(Context& context, const Grip& grip) {
  return std::make_unique<Dragging>(context, grip);
}

}  // namespace limber::editor
