// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/difference_overlay.h"

#include "editor/context/background_task.h"
#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/pointer_context.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/overlap_overlay.h"
#include "editor/resample/results.h"
#include "editor/shown/compare_wipe.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/mark_colours.h"
#include "editor/ui/ui.h"
#include "editor/volume/tissue_edits.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

std::shared_ptr<const LabelVolume> volume_of(const Context& context, const std::string& name) {
  const auto result = result_named(context.document(), name);
  return result ? result->volume : context.document().volume;
}

ComparedSide compared(const std::shared_ptr<const LabelVolume>& volume, const LabelVolume& other,
                      const TissueTable& tissues, bool side_a) {
  ComparedSide side{volume, std::make_shared<const TissueVoxels>(*volume), {}, nullptr};
  side.differing = differing(*volume, *side.tissue, other);
  const std::vector<glm::u8vec3> dull = dull_colours(tissues);
  const MarkColours marks = marks_of(side_a);
  const glm::u8vec3 air = bytes_of(marks.air), another = bytes_of(marks.tissue);
  std::vector<glm::u8vec3> field(side.differing.voxels.size());
  side.tissue->for_each([&](std::int64_t place, const glm::ivec3& voxel) {
    const Differs differs = side.differing.voxels[static_cast<std::size_t>(place)];
    field[static_cast<std::size_t>(place)] = differs == Differs::Air      ? air
                                             : differs == Differs::Tissue ? another
                                                                          : dull[volume->at(voxel)];
  });
  side.field = std::make_shared<const std::vector<glm::u8vec3>>(std::move(field));
  return side;
}

void put_into(render::Scene& scene, const ComparedSide& side) {
  if (scene.volume != side.volume) return;
  scene.outlined.reset();
  scene.weights = render::ShownWeights{.weights = nullptr,
                                       .tissue = side.tissue,
                                       .display = render::WeightDisplay::Field,
                                       .swatches = nullptr,
                                       .region = nullptr,
                                       .field = side.field,
                                       .contours = false};
}

}  // namespace

MarkColours marks_of(bool side_a) {
  const glm::vec3 colour = render::srgb(side_a ? 0xB07AD9 : 0x3FB6A8);
  return {colour, glm::mix(colour, glm::vec3(1), 0.6f)};
}

bool shows_difference(const Context& context) {
  return context.difference->shown && context.workspace() == Workspace::Resample && !watched_solve(context) &&
         why_no_comparison(context).empty();
}

void show_difference_overlay(Context& context, bool on) {
  context.difference->shown = on;
  if (!on) return;
  context.fem_overlay->measure.reset();
  context.overlap->shown = false;
}

const ComparedVolumes* compared_volumes(const Context& context) {
  const auto& made = context.difference->made;
  const bool fits = made && made->a.volume == volume_of(context, context.comparison->a) &&
                    made->b.volume == volume_of(context, context.comparison->b) &&
                    made->tissues == context.document().tissues;
  return fits ? made.get() : nullptr;
}

void show_difference(Context& context) {
  DifferenceView& view = *context.difference;
  if (!shows_difference(context)) {
    if (!view.shown) view.made.reset();
    return;
  }
  const ComparedVolumes* made = compared_volumes(context);
  if (!made) {
    if (view.task && context.background->tasks.contains(*view.task)) return;
    const auto a = volume_of(context, context.comparison->a), b = volume_of(context, context.comparison->b);
    view.task = start_task(context, "", [a, b, tissues = context.document().tissues](Progress&) -> Finish {
      auto both = std::make_shared<const ComparedVolumes>(
          ComparedVolumes{compared(a, *b, *tissues, true), compared(b, *a, *tissues, false), tissues});
      return [both](Context& c) {
        c.difference->made = both;
        c.ui->touch();
      };
    });
    return;
  }
  Views& views = *context.views;
  const bool a_alone = !views.other_scene && context.comparison->shows_a;
  put_into(views.scene, made->side(a_alone));
  if (views.other_scene) put_into(*views.other_scene, made->a);
}

std::string other_side_text_at(const Context& context, const glm::ivec3& voxel) {
  const ComparedVolumes* made = shows_difference(context) ? compared_volumes(context) : nullptr;
  const ViewPlace* view = hovered_view(context);
  if (!made || !view) return "";
  const bool on_a = context.views->other_scene ? over_side_a(context, *view) : context.comparison->shows_a;
  const LabelVolume &here = *made->side(on_a).volume, &there = *made->side(!on_a).volume;
  const glm::dvec3 place = voxel_from_world(there.grid) * (world_from_voxel(here.grid) * glm::dvec3(voxel));
  const Label label = there.at_or_air(glm::ivec3(glm::floor(place + 0.5)));
  const Tissue* tissue = label ? made->tissues->find(label) : nullptr;
  return std::string(on_a ? "in B: " : "in A: ") + (tissue  ? shown_name(*tissue)
                                                    : label ? "label " + std::to_string(label)
                                                            : "nothing");
}

}  // namespace limber::editor
