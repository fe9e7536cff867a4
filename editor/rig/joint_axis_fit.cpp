// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/joint_axis_fit.h"

#include <cstdio>

#include "core/rig/edit_armature.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator_button.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/widgets.h"
#include "editor/volume/body_seams.h"
#include "editor/volume/volume_edits.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

constexpr glm::vec3 kColliding = render::srgb(0xFF3EA5);

std::shared_ptr<const std::vector<glm::u8vec3>> coloured(const LabelVolume& volume, const TissueVoxels& tissue,
                                                         const TissueTable& tissues,
                                                         const std::vector<glm::ivec3>& colliding) {
  std::vector<glm::u8vec3> of_label(65536, glm::u8vec3(178));
  for (const Tissue& one : tissues.tissues) of_label[one.label] = glm::u8vec3(glm::round(one.colour * 255.0f));
  auto colours = std::make_shared<std::vector<glm::u8vec3>>(tissue.size());
  tissue.for_each([&](std::int64_t place, const glm::ivec3& voxel) { (*colours)[place] = of_label[volume.at(voxel)]; });
  for (const glm::ivec3& voxel : colliding)
    (*colours)[tissue.index_of(voxel)] = glm::u8vec3(glm::round(kColliding * 255.0f));
  return colours;
}

bool is_hinge(const ProposedJoint& proposed) {
  const auto bone = proposed.from->find(proposed.bone);
  return bone && proposed.from->bones[static_cast<std::size_t>(*bone)].limits.type == JointLimits::Type::Hinge;
}

std::string motion_text(const ProposedJoint& proposed) {
  char text[96];
  std::snprintf(text, sizeof text,
                is_hinge(proposed) ? "The axis moves by %.1f mm and turns by %.1f\u00b0"
                                   : "Becomes a hinge, moved %.1f mm, turned %.1f\u00b0",
                proposed.fit.moved_mm, proposed.fit.turned_degrees);
  return text;
}

void propose(Context& context, ProposedJoint proposed) {
  if (context.document().volume != proposed.volume || context.document().armature != proposed.from)
    return context.messages->warn("Joint axis of " + proposed.bone,
                                  "The rig or the volume was changed meanwhile: start the fit again");
  if (proposed.fit.overlap_before == 0)
    return context.messages->ok("Joint axis of " + proposed.bone,
                                "The bones do not collide within the joint's range: the axis needs no change");
  context.transform_settings->proposed_joint = std::make_shared<ProposedJoint>(std::move(proposed));
  context.ui->touch();
}

}  // namespace

void start_joint_fit(Context& context) {
  leave_proposed_joint(context);
  const Document from = context.document();
  const int bone = *context.selection->bone;
  const JointLimits& limits = from.armature->bones[bone].limits;
  // A joint that is not a hinge is fitted as a hinge about its flexion axis, over the range of angles that FitJoint has
  // by default.
  FitJoint settings;
  if (limits.type == JointLimits::Type::Hinge)
    settings = {.minimum_degrees = glm::degrees(limits.minimum), .maximum_degrees = glm::degrees(limits.maximum)};
  const bool both_sides = context.transform_settings->x_mirror;
  const int id =
      start_task(context, "Fit joint axis of " + from.armature->bones[bone].name, [=](Progress& progress) -> Finish {
        ProposedJoint proposed{.volume = from.volume,
                               .from = from.armature,
                               .fitted = nullptr,
                               .bone = from.armature->bones[bone].name,
                               .fit = {},
                               .tissue = nullptr,
                               .colours = {}};
        proposed.tissue = std::make_shared<const TissueVoxels>(*from.volume);
        const BoneParts parts = split_bones(*from.volume, *proposed.tissue, *from.tissues, *from.armature, progress,
                                            usable_bone_map(seam_source(from)));
        proposed.fit = fit_joint(*from.volume, *proposed.tissue, parts, *from.armature, bone, settings, progress);
        proposed.fitted = std::make_shared<const Armature>(
            both_sides ? with_mirrored_changes(*from.armature, proposed.fit.armature) : proposed.fit.armature);
        proposed.colours = {coloured(*from.volume, *proposed.tissue, *from.tissues, proposed.fit.colliding_before),
                            coloured(*from.volume, *proposed.tissue, *from.tissues, proposed.fit.colliding_after)};
        return [proposed](Context& c) { propose(c, proposed); };
      });
  context.background->step_of_job[id] = StepOfWork::Rig;
}

const ProposedJoint* proposed_joint(const Context& context) {
  const auto& proposed = context.transform_settings->proposed_joint;
  const bool here = proposed && context.workspace() == Workspace::Rig &&
                    context.document().volume == proposed->volume && context.document().armature == proposed->from;
  return here ? proposed.get() : nullptr;
}

void show_proposed_joint(Context& context) {
  const ProposedJoint* proposed = proposed_joint(context);
  render::Scene& scene = context.views->scene;
  if (!proposed || scene.volume != proposed->volume) return;
  scene.display = render::Display::XRay;  // soft tissue would hide the bones
  scene.bones_in_front = true;
  scene.bone_shape = render::BoneShape::Stick;  // a thicker shape would hide the collisions
  scene.outlined.reset();
  if (scene.armature && proposed->shows_after) scene.armature = proposed->fitted;
  scene.weights = render::ShownWeights{.weights = nullptr,
                                       .tissue = proposed->tissue,
                                       .display = render::WeightDisplay::Field,
                                       .swatches = nullptr,
                                       .region = nullptr,
                                       .field = proposed->colours[proposed->shows_after],
                                       .contours = false};
}

void take_proposed_joint(Context& context) {
  const auto proposed = context.transform_settings->proposed_joint;
  leave_proposed_joint(context);
  Document next = context.document();
  next.armature = proposed->fitted;
  const std::string label = "Fit joint axis of " + proposed->bone;
  commit(context, label, std::move(next));
  warn_of_moved_targets(context, label, *proposed->from);
}

void leave_proposed_joint(Context& context) {
  context.transform_settings->proposed_joint.reset();
  context.ui->touch();
}

void draw_proposed_joint(Context& context, const Rect& view) {
  const ProposedJoint* proposed = proposed_joint(context);
  if (!proposed) return;
  const Look& look = context.ui->look;
  const FittedJoint& fit = proposed->fit;
  constexpr float kWidth = 322, kHeight = 148, kMargin = 12, kRow = 26;
  const glm::vec2 low{view.low.x + look.px(kMargin), view.high.y - look.px(kMargin + kHeight)};
  const Rect box{low, low + glm::vec2(look.px(kWidth), look.px(kHeight))};
  const PathScope path(context.ui, "joint axis");
  register_widget(context.ui, "box", box);
  fill(box, with_alpha(look.theme.panel, 0.94f), look.px(5));
  outline(box, look.theme.line2, look.px(5), look.line());
  const float left = box.low.x + look.px(10), right = box.high.x - look.px(10);
  float y = box.low.y + look.px(4);
  const auto line = [&](ImFont* font, Colour colour, const std::string& words, Align align = Align::Left) {
    put_text(context.ui, font, colour, Rect{{left, y}, {right, y + look.px(kRow)}}, words, align);
  };
  line(look.fonts.semibold, look.theme.text, "Joint axis of " + proposed->bone);
  y += look.px(kRow);
  fill({{left, y + look.px(6)}, {left + look.px(14), y + look.px(20)}}, rgb(kColliding.r, kColliding.g, kColliding.b),
       look.px(3));
  put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{left + look.px(22), y}, {right, y + look.px(kRow)}},
           "Bone overlap, worst angle");
  line(look.fonts.mono, fit.overlap_after > 0 ? look.theme.warn : look.theme.ok,
       grouped(fit.overlap_before) + " \u2192 " + grouped(fit.overlap_after), Align::Right);
  y += look.px(kRow);
  line(look.fonts.regular, look.theme.text2, motion_text(*proposed));
  y += look.px(kRow + 2);
  const float half = (right - left - look.px(1)) / 2;
  const auto side = [&](const char* id, const char* words, float from, bool on) {
    operator_button(context, id, {{from, y}, {from + half, y + look.px(kRow)}}, words,
                    on ? ButtonStyle::Chosen : ButtonStyle::Plain);
  };
  side("rig.joint_fit_before", "Before", left, !proposed->shows_after);
  side("rig.joint_fit_after", "After", left + half + look.px(1), proposed->shows_after);
  y += look.px(kRow + 8);
  operator_button(context, "rig.leave_joint_fit",
                  {{right - look.px(190), y}, {right - look.px(104), y + look.px(kRow)}}, "Keep old axis");
  operator_button(context, "rig.take_joint_fit", {{right - look.px(96), y}, {right, y + look.px(kRow)}}, "Use fit",
                  ButtonStyle::Primary);
}

}  // namespace limber::editor
