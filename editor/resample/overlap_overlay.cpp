// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/overlap_overlay.h"

#include <algorithm>

#include "editor/context/background_task.h"
#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/mark_colours.h"
#include "editor/ui/ui.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

// Number of results that stay cached: results A and B of the current comparison and of the comparison before it.
constexpr std::size_t kRemembered = 4;

std::shared_ptr<const MarkedOverlap> marked(const Result& result, const std::shared_ptr<const TissueTable>& tissues) {
  auto made = std::make_shared<MarkedOverlap>(MarkedOverlap{
      result.overlap, result.volume, tissues, std::make_shared<const TissueVoxels>(*result.volume), nullptr});
  const std::vector<glm::u8vec3> dull = dull_colours(*tissues);
  std::vector<glm::u8vec3> field(static_cast<std::size_t>(made->tissue->size()));
  made->tissue->for_each([&](std::int64_t place, const glm::ivec3& voxel) {
    field[static_cast<std::size_t>(place)] = dull[result.volume->at(voxel)];
  });
  const glm::ivec3 size = result.volume->grid.size;
  for (const bool of_bones : {false, true})
    for (const std::int64_t voxel : of_bones ? result.overlap->bones : result.overlap->tissue) {
      const glm::ivec3 at(voxel % size.x, voxel / size.x % size.y, voxel / (std::int64_t{size.x} * size.y));
      if (const std::int64_t place = made->tissue->index_of(at); place >= 0)
        field[static_cast<std::size_t>(place)] = bytes_of(mark_of_overlap(of_bones));
    }
  made->field = std::make_shared<const std::vector<glm::u8vec3>>(std::move(field));
  return made;
}

void put_into(Context& context, render::Scene& scene, const std::shared_ptr<const Result>& result) {
  if (!result || !result->overlap || scene.volume != result->volume) return;
  OverlapView& view = *context.overlap;
  const auto& tissues = context.document().tissues;
  const auto found = std::find_if(view.made.begin(), view.made.end(), [&](const auto& one) {
    return one->overlap == result->overlap && one->volume == result->volume && one->tissues == tissues;
  });
  if (found != view.made.end()) {
    scene.outlined.reset();
    scene.weights = render::ShownWeights{.weights = nullptr,
                                         .tissue = (*found)->tissue,
                                         .display = render::WeightDisplay::Field,
                                         .swatches = nullptr,
                                         .region = nullptr,
                                         .field = (*found)->field,
                                         .contours = false};
    return;
  }
  if (view.task && context.background->tasks.contains(*view.task)) return;
  view.task = start_task(context, "", [result, tissues](Progress&) -> Finish {
    return [made = marked(*result, tissues)](Context& c) {
      auto& all = c.overlap->made;
      all.push_back(made);
      if (all.size() > kRemembered) all.erase(all.begin());
      c.ui->touch();
    };
  });
}

}  // namespace

glm::vec3 mark_of_overlap(bool of_bones) { return render::srgb(of_bones ? 0xF3CF45 : 0xFF3EA5); }

std::string why_no_overlap(const Context& context) {
  if (context.document().results.empty()) return "Resample a pose first";
  const auto kept = [&](const std::shared_ptr<const Result>& result) { return result && result->overlap; };
  if (kept(chosen_result(context)) ||
      (comparing(context) && kept(result_named(context.document(), context.comparison->a))))
    return "";
  return "The overlap of this result is not stored: resample its pose again";
}

bool shows_overlap(const Context& context) {
  return context.overlap->shown && context.workspace() == Workspace::Resample && !watched_solve(context) &&
         why_no_overlap(context).empty();
}

void show_overlap_overlay(Context& context, bool on) {
  context.overlap->shown = on;
  if (!on) return;
  context.fem_overlay->measure.reset();
  context.difference->shown = false;
}

void show_overlap(Context& context) {
  if (!context.overlap->shown) context.overlap->made.clear();
  if (!shows_overlap(context)) return;
  Views& views = *context.views;
  put_into(context, views.scene, shown_result(context));
  if (views.other_scene) put_into(context, *views.other_scene, result_named(context.document(), context.comparison->a));
}

}  // namespace limber::editor
