// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/rig_transform_tool.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/layout.h"
#include "editor/context/selection.h"
#include "editor/input/keymap_overrides.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/viewport/angle_drag.h"
#include "editor/viewport/snap.h"

namespace limber::editor {

namespace {

constexpr double kSnapMillimetres = 5, kSnapFineMillimetres = 1, kSnapDegrees = 5, kSnapFine = 1, kSnapScale = 0.1,
                 kSnapScaleFine = 0.01;
// A moved joint snaps to joints within this distance of the pointer, pixels at scale 1.
constexpr double kSnapPixels = 14;
constexpr double kLeastScale = 1e-3;

// Returns the change's pivot: the point about which bones turn or scale, or the point that is moved. The pivot of a
// roll is the bone's middle.
glm::dvec3 pivot_of(const RigChange& change) {
  const BoneEnd& end = change.ends.front();
  const Bone& bone = change.start.bones[end.bone];
  return change.kind == RigChange::Kind::Roll ? (bone.head + bone.tail) / 2.0 : place_of(change.start, end);
}

class RigTool final : public TransformTool {
 public:
  RigTool(Context& context, RigChange change, const Grip& grip)
      : TransformTool(context, grip),
        change_(std::move(change)),
        pivot_(pivot_of(change_)),
        angle_(view_, context.ui->look.scale, pivot_, grip.held && grip.lock.axis >= 0) {
    angle_.about(axis(), start_, pointer_);
    show(context);
  }

  std::string title() const override {
    return change_.label + " " + number(true) + lock_text(turns() ? "about" : "along") +
           (snapped_to_.empty() ? "" : ", " + snapped_to_);
  }
  std::vector<KeyHint> hints(const Context&) const override { return shared_hints(); }
  void cancel(Context& context) override { drop_shown_rig(context); }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const GizmoPainter painter(context, view_);
    const Theme& theme = context.ui->look.theme;
    if (turns()) angle_.draw(painter, theme, shown_);
    else if (lock_.axis >= 0 && !lock_.plane) {
      const double far = view_.millimetres_per_pixel(pivot_) * 2000;
      painter.line(pivot_ - far * lock_axis(), pivot_ + far * lock_axis(), with_alpha(theme.axis[lock_.axis], 0.6f), 1);
    }
    const glm::dvec3 at = change_.kind == RigChange::Kind::Move ? target_ : pivot_;
    if (change_.kind == RigChange::Kind::Move) painter.circle(at, 0xFFFFFFFF, 9, 1.6f);
    const Bone& bone = change_.start.bones[change_.ends.front().bone];
    const std::string lock = lock_text(turns() ? "about" : "along");
    painter.read_out(at, number(true), lock.empty() ? "" : lock.substr(1),
                     snapped_to_.empty() ? bone.name : "snap: " + snapped_to_, theme.view_text2);
  }

 private:
  glm::dmat3 axes(Space space) const override {
    return axes_of(space, change_.start, rest_pose(change_.start), change_.ends.front().bone, view_);
  }
  bool turns() const { return change_.kind == RigChange::Kind::Turn || change_.kind == RigChange::Kind::Roll; }
  glm::dvec3 axis() const {
    const Bone& bone = change_.start.bones[change_.ends.front().bone];
    if (change_.kind == RigChange::Kind::Roll) return rest_axes(bone)[1];
    const glm::dvec3 locked = lock_axis();
    return locked == glm::dvec3(0) ? view_.towards_eye : locked;
  }

  void follow(Context&, const glm::dvec2& from, const glm::dvec2& to) override { angle_.follow(from, to); }
  void locked(Context&) override {
    angle_.leave_ring();
    angle_.about(axis(), start_, pointer_);
  }

  std::string number(bool unit) const {
    const char* units[] = {" mm", "\u00b0", "", "\u00b0"};
    const char* formats[] = {"%.1f", "%+.1f", "%.3f", "%+.1f"};
    const int kind = static_cast<int>(change_.kind);
    return (number_.typed() ? number_.text() : text_of_number(formats[kind], shown_)) + (unit ? units[kind] : "");
  }

  bool is_moved(int bone, bool tail) const {
    for (const BoneEnd& end : change_.ends)
      for (const BoneEnd& one : joint_of(change_.start, end))
        if (one == BoneEnd{bone, tail}) return true;
    return false;
  }

  std::optional<glm::dvec3> joint_below(const Context& context) const {
    double nearest = kSnapPixels * context.ui->look.scale;
    std::optional<glm::dvec3> found;
    for (int bone = 0; bone < std::ssize(change_.start.bones); ++bone)
      for (const bool tail : {false, true}) {
        const glm::dvec3 place = place_of(change_.start, {bone, tail});
        const auto pixel = view_.shows(place) ? view_.pixel_of(place) : std::nullopt;
        if (!pixel || is_moved(bone, tail) || glm::distance(*pixel, pointer_) > nearest) continue;
        nearest = glm::distance(*pixel, pointer_);
        found = place;
      }
    return found;
  }

  // Returns the point projected onto the locked axis or plane; unchanged when no axis is locked.
  glm::dvec3 held(const glm::dvec3& place) const {
    const glm::dvec3 axis = lock_axis();
    if (axis == glm::dvec3(0)) return place;
    const double along = glm::dot(place - pivot_, axis);
    return lock_.plane ? place - along * axis : pivot_ + along * axis;
  }

  glm::dvec3 moved_to(const Context& context) {
    snapped_to_.clear();
    const Snap snap = context.transform_settings->snap;
    if (way_ || snap == Snap::Steps || context.ui->input.down(Key::Ctrl) == context.transform_settings->snapping ||
        number_.typed())
      return dragged(context, pivot_, kSnapMillimetres, kSnapFineMillimetres);
    const glm::dvec3 free = dragged(context, pivot_, 0, 0);
    const auto place = snap == Snap::Joint   ? joint_below(context)
                       : snap == Snap::Voxel ? nearest_voxel(context.document(), free)
                                             : middle_of_bone(context.document(), view_, pointer_);
    if (!place) return free;
    snapped_to_ = snap == Snap::Joint ? "joint" : snap == Snap::Voxel ? "voxel" : "middle of bone tissue";
    return held(*place);
  }

  Armature changed(Context& context) {
    switch (change_.kind) {
      case RigChange::Kind::Move: {
        target_ = moved_to(context);
        const glm::dvec3 by = target_ - pivot_;
        shown_ = glm::length(by);
        return with_moved_ends(change_.start, change_.ends, [&](const glm::dvec3& p) { return p + by; });
      }
      case RigChange::Kind::Roll:
      case RigChange::Kind::Turn: {
        shown_ = number_.typed() ? number_.value() : snapped(context, angle_.degrees(), kSnapDegrees, kSnapFine);
        if (change_.kind == RigChange::Kind::Roll) return rolled(change_.start, change_.chosen, glm::radians(shown_));
        const glm::dquat turn = glm::angleAxis(glm::radians(shown_), axis());
        return with_moved_ends(change_.start, change_.ends,
                               [&](const glm::dvec3& p) { return pivot_ + turn * (p - pivot_); });
      }
      case RigChange::Kind::Scale: {
        const glm::dvec2 centre = view_.pixel_of(pivot_).value_or(start_);
        const double before = std::max(1.0, glm::distance(start_, centre));
        shown_ = number_.typed() ? number_.value()
                                 : std::max(kLeastScale, snapped(context, glm::distance(pointer_, centre) / before,
                                                                 kSnapScale, kSnapScaleFine));
        const glm::dvec3 axis = lock_axis();
        return with_moved_ends(change_.start, change_.ends, [&](const glm::dvec3& p) {
          const glm::dvec3 off = p - pivot_, along = axis * glm::dot(off, axis);
          if (axis == glm::dvec3(0)) return pivot_ + off * shown_;
          return lock_.plane ? pivot_ + along + (off - along) * shown_ : pivot_ + off + along * (shown_ - 1);
        });
      }
    }
    return change_.start;
  }

  std::vector<FormField> parameters() const override {
    switch (change_.kind) {
      case RigChange::Kind::Move: return fields_of_way(target_ - pivot_);
      case RigChange::Kind::Roll:
        return {number_of("Angle", "Angle by which the bones turn about their own axes.", shown_, -360, 360, "%.2f",
                          "\u00b0")};
      case RigChange::Kind::Turn: break;
      case RigChange::Kind::Scale: break;
    }
    std::vector<FormField> fields = fields_of_axis();
    const bool turn = change_.kind == RigChange::Kind::Turn;
    fields.insert(
        fields.begin(),
        turn ? number_of("Angle", "Angle by which the bones turn.", shown_, -360, 360, "%.2f", "\u00b0")
             : number_of("Factor", "Factor by which lengths are multiplied.", shown_, kLeastScale, 100, "%.3f"));
    return fields;
  }
  void set(const std::vector<FormField>& fields) override {
    if (change_.kind == RigChange::Kind::Move) return set_way(fields);
    number_.set(fields[0].value);
    if (change_.kind != RigChange::Kind::Roll) set_axis(fields, 1);
  }

  void show(Context& context) override { show_rig(context, mirrored_too(context, changed(context))); }
  void keep(Context& context) override {
    Armature next = mirrored_too(context, changed(context));
    // An extruded bone whose tail was not moved has zero length, so it is not added.
    const bool nothing = std::any_of(change_.chosen.begin(), change_.chosen.end(),
                                     [&](int bone) { return next.bones[bone].head == next.bones[bone].tail; });
    if (nothing) {
      if (change_.kind == RigChange::Kind::Scale)
        context.messages->warn("Nothing was scaled", "A bone cannot have zero length: type a factor above 0");
      return drop_shown_rig(context);
    }
    commit_rig(context, change_.label, std::move(next), change_.chosen);
  }

  RigChange change_;
  glm::dvec3 pivot_, target_ = pivot_;
  AngleDrag angle_;
  double shown_ = 0;  // the number in the tool's title: mm, degrees or a factor
  std::string snapped_to_;
};

}  // namespace

std::unique_ptr<TransformTool> begin_rig_change(Context& context, const RigChange& change, const Grip& grip) {
  return std::make_unique<RigTool>(context, change, grip);
}

std::vector<int> bones_chosen_last(const Context& context) {
  const int active = *context.selection->bone;
  std::vector<int> bones;
  for (const int bone : context.selection->bones)
    if (bone != active && bone < std::ssize(context.document().armature->bones)) bones.push_back(bone);
  bones.push_back(active);
  return bones;
}

std::string naming_chosen(const Context& context, const std::string& verb) {
  const std::vector<int> bones = bones_chosen_last(context);
  return verb + " " +
         (bones.size() == 1 ? context.document().armature->bones[bones[0]].name
                            : std::to_string(bones.size()) + " bones");
}

RigChange chosen_change(const Context& context, RigChange::Kind kind) {
  constexpr const char* kVerbs[] = {"Move", "Rotate", "Scale", "Roll"};
  RigChange change{kind,
                   naming_chosen(context, kVerbs[static_cast<int>(kind)]),
                   *context.document().armature,
                   {},
                   bones_chosen_last(context)};
  const TransformSettings::Part part = context.transform_settings->part;
  if (kind == RigChange::Kind::Move && part != TransformSettings::Part::Whole)
    change.ends = {{change.chosen.back(), part == TransformSettings::Part::Tail}};
  // The ends of the active bone come first, because the first end is the pivot of turning and scaling.
  else
    for (auto bone = change.chosen.rbegin(); bone != change.chosen.rend(); ++bone)
      change.ends.insert(change.ends.end(), {{*bone, false}, {*bone, true}});
  return change;
}

RigChange extrusion(const Context& context) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  const BoneEnd from{*context.selection->bone, context.transform_settings->part != TransformSettings::Part::Head};
  const int added = static_cast<int>(armature->bones.size());
  return {RigChange::Kind::Move,
          "Extrude " + armature->bones[from.bone].name,
          extruded(*armature, from, place_of(*armature, from)),
          {{added, true}},
          {added}};
}

}  // namespace limber::editor
