// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal tool that blends the selected bones from one pose towards another one, or away from it.
#include <algorithm>
#include <cmath>

#include "core/rig/joint_limits.h"
#include "editor/context/context.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_tools.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr double kPixels = 200;                  // pointer motion that changes the blend amount by 1, pixels at scale 1
constexpr double kSnap = 0.1, kSnapFine = 0.01;  // snapping steps of the blend amount: Ctrl, Ctrl + Shift

// Returns the rotation at `share` of the shortest turn from one rotation to another. A share outside [0, 1]
// extrapolates.
glm::dquat along(const glm::dquat& from, const glm::dquat& to, double share) {
  glm::dquat by = glm::conjugate(from) * to;
  if (by.w < 0) by = -by;
  const glm::dvec3 v(by.x, by.y, by.z);
  const double sine = glm::length(v);
  if (sine == 0) return from;
  return glm::normalize(from * exponential(v * (2 * std::atan2(sine, by.w) / sine * share)));
}

class Blending final : public TransformTool {
 public:
  Blending(Context& context, PoseBlend blend)
      : TransformTool(context, {}),
        blend_(std::move(blend)),
        armature_(context.document().armature),
        before_(pose_of(context.document())),
        bones_(chosen_bones(context)),
        amount_(blend_.begin),
        scale_(context.ui->look.scale) {
    show(context);
  }

  std::string title() const override {
    return blend_.label + " " + (number_.typed() ? number_.text() : text_of_number("%.0f", 100 * amount_)) + " %";
  }
  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"0-9"}, "Type a percentage"},
            {{"Ctrl"}, "Snap"},
            {{"Shift"}, "Precise"},
            {{"Enter"}, "Confirm"},
            {{"Esc"}, "Cancel"}};
  }
  void cancel(Context& context) override { drop_shown_pose(context); }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const int bone = bones_.front();
    const glm::dvec3 pivot = posed_from_rest(*armature_, seen_pose(context))[bone] * armature_->bones[bone].head;
    const std::string number = (number_.typed() ? number_.text() : text_of_number("%.0f", 100 * amount_)) + " %";
    GizmoPainter(context, view_).read_out(pivot, number, blend_.label, blend_.words, context.ui->look.theme.view_text2);
  }

 private:
  glm::dmat3 axes(Space) const override { return glm::dmat3(1); }

  Pose pose(Context& context) {
    const double dragged = blend_.begin + (pointer_.x - start_.x) / (kPixels * scale_);
    amount_ = number_.typed() ? number_.value() / 100
                              : std::clamp(snapped(context, dragged, kSnap, kSnapFine),
                                           blend_.back ? -blend_.most : 0.0, blend_.most);
    const bool back = blend_.back && amount_ < 0;
    const double share = back ? -amount_ : blend_.base + blend_.slope * amount_;
    const Pose& to = back ? *blend_.back : blend_.to;
    Pose next = before_;
    for (const int bone : bones_) {
      next.rotation[bone] = along(blend_.from.rotation[bone], to.rotation[bone], share);
      if (armature_->bones[bone].parent < 0)
        next.root_translation = glm::mix(blend_.from.root_translation, to.root_translation, share);
    }
    return limited(context, std::move(next), bones_);
  }

  std::vector<FormField> parameters() const override {
    return {number_of("Amount", "How far the selected bones are blended.", 100 * amount_,
                      blend_.back ? -100 * blend_.most : 0, 100 * blend_.most, "%.1f", "%")};
  }
  void set(const std::vector<FormField>& fields) override { number_.set(fields[0].value); }

  void show(Context& context) override { preview_pose(context, pose(context)); }
  void keep(Context& context) override { commit_pose(context, blend_.label, pose(context)); }

  PoseBlend blend_;
  std::shared_ptr<const Armature> armature_;
  const Pose before_;
  std::vector<int> bones_;
  double amount_;
  float scale_;
};

}  // namespace

std::unique_ptr<TransformTool> begin_blending(Context& context, const PoseBlend& blend) {
  return std::make_unique<Blending>(context, blend);
}

}  // namespace limber::editor
