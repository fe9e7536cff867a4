// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/fem_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/base/parallel.h"
#include "core/mesh/mesh_cut.h"
#include "editor/context/background_task.h"
#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/pointer_context.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/resample/results.h"
#include "editor/shown/compare_wipe.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

// Number of meshes that stay cached: two sides of a comparison times two measures.
constexpr std::size_t kRemembered = 4;

// Colours of the volume ratio: blue is compressed, red is swollen. Darker colours mean a stronger change.
constexpr std::array<glm::vec3, 5> kChange = {render::srgb(0x15294F), render::srgb(0x2C5CA6), render::srgb(0xC9CDD4),
                                              render::srgb(0xC0572F), render::srgb(0x591B0E)};

template <std::size_t count>
glm::vec3 between(const std::array<glm::vec3, count>& colours, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * (count - 1);
  const std::size_t step = std::min(static_cast<std::size_t>(at), count - 2);
  return glm::mix(colours[step], colours[step + 1], static_cast<float>(at - double(step)));
}

std::optional<ShownMesh> mesh_of(const std::shared_ptr<const Result>& result) {
  if (!result || !result->solved || !result->volume) return std::nullopt;
  const auto& solved = result->solved;
  return ShownMesh{result->volume, {solved, &solved->mesh}, {solved, &solved->V}, false};
}

// Returns the mesh that the views show. If `other_side` is true, returns the mesh of result A of the comparison.
// Returns nothing when there is no mesh, and in workspaces other than Resample and Pose.
std::optional<ShownMesh> shown_mesh(const Context& context, bool other_side) {
  if (context.workspace() != Workspace::Resample && context.workspace() != Workspace::Pose) return std::nullopt;
  if (other_side) return mesh_of(result_named(context.document(), context.comparison->a));
  if (const Solve* solve = watched_solve(context)) {
    const SolveFeed::Seen seen = solve->feed->seen();
    return ShownMesh{solve->from.volume, seen.rest, seen.mesh.posed, true};
  }
  return mesh_of(shown_result(context));
}

// Computes the colours of a mesh for a measure such as the volume ratio. If `before` is the same mesh with other node
// positions or another measure, reuses its faces and its tet of each voxel.
std::shared_ptr<const MeasuredMesh> measured(const ShownMesh& of, const std::optional<FemMeasure>& measure,
                                             const std::shared_ptr<const MeasuredMesh>& before) {
  auto made = std::make_shared<MeasuredMesh>();
  made->of = of;
  made->measure = measure;
  const TetMesh& mesh = of.rest->tets;
  const bool same_mesh = before && before->of.rest == of.rest;
  made->faces = same_mesh ? before->faces : std::make_shared<const Eigen::MatrixX3i>(faces_of(mesh.T));
  if (same_mesh) made->tissue = before->tissue, made->tets = before->tets;
  if (!measure) return made;
  if (!made->tissue || before->of.volume != of.volume) {
    made->tissue = std::make_shared<const TissueVoxels>(*of.volume);
    made->tets = std::make_shared<const std::vector<std::int32_t>>(
        tets_of_voxels(mesh.T, of.settling ? mesh.V : *of.posed, of.volume->grid, *made->tissue));
  }
  made->values = fem_measure(*measure, *of.rest, *of.posed);
  made->least = std::numeric_limits<float>::infinity();
  made->most = -made->least;
  std::vector<glm::u8vec3> colours(made->values.size());
  for (std::size_t t = 0; t < colours.size(); ++t) {
    colours[t] = glm::u8vec3(glm::round(colour_of(*measure, made->values[t]) * 255.0f));
    if (!of.rest->is_soft(static_cast<std::int64_t>(t)) || std::isnan(made->values[t])) continue;
    made->least = std::min(made->least, made->values[t]);
    made->most = std::max(made->most, made->values[t]);
  }
  const glm::u8vec3 rest(glm::round(colour_of(*measure, measure_at_rest(*measure)) * 255.0f));
  std::vector<glm::u8vec3> field(made->tets->size());
  for (std::size_t i = 0; i < field.size(); ++i)
    field[i] = (*made->tets)[i] < 0 ? rest : colours[static_cast<std::size_t>((*made->tets)[i])];
  made->field = std::make_shared<const std::vector<glm::u8vec3>>(std::move(field));
  return made;
}

// Returns the newest cached mesh that has colours of the overlay's measure and the current node positions. If there is
// none, returns a cached mesh with earlier node positions, because a running solve moves the nodes at every step.
std::shared_ptr<const MeasuredMesh> known(const FemOverlay& overlay, const ShownMesh& of) {
  const auto fits = [&](const auto& made, bool behind) {
    return made->of.volume == of.volume && made->of.rest == of.rest && (behind || made->of.posed == of.posed) &&
           (!overlay.measure || made->measure == overlay.measure);
  };
  for (const bool behind : {false, true})
    for (auto made = overlay.made.rbegin(); made != overlay.made.rend(); ++made)
      if (fits(*made, behind)) return *made;
  return nullptr;
}

const MeasuredMesh* measured_in(const FemOverlay& fem_overlay, const render::Scene& scene) {
  if (!scene.weights || !scene.weights->field) return nullptr;
  for (const auto& made : fem_overlay.made)
    if (made->field == scene.weights->field) return made.get();
  return nullptr;
}

void put_into(Context& context, render::Scene& scene, const ShownMesh& of) {
  FemOverlay& overlay = *context.fem_overlay;
  const auto made = known(overlay, of);
  if ((!made || made->of.posed != of.posed) && !(overlay.task && context.background->tasks.contains(*overlay.task))) {
    std::shared_ptr<const MeasuredMesh> before;
    for (const auto& one : overlay.made)
      if (one->of.rest == of.rest && one->of.volume == of.volume && one->tissue) before = one;
    overlay.task = start_task(
        context, "",
        [of, before, measure = overlay.measure](Progress&) -> Finish {
          return [made = measured(of, measure, before)](Context& c) {
            auto& all = c.fem_overlay->made;
            if (made->of.settling) std::erase_if(all, [](const auto& one) { return one->of.settling; });
            all.push_back(made);
            if (all.size() > kRemembered) all.erase(all.begin());
            c.ui->touch();
          };
        },
        [](Context& c, const std::string& error) {
          c.fem_overlay->measure.reset();
          c.fem_overlay->tets = false;
          c.messages->show_error(error, "Overlay of finite elements");
        });
  }
  if (!made || scene.volume != of.volume) return;
  if (overlay.tets) scene.mesh = {made->faces, made->of.posed};
  if (!overlay.measure) return;
  scene.outlined.reset();
  scene.weights = render::ShownWeights{.weights = nullptr,
                                       .tissue = made->tissue,
                                       .display = render::WeightDisplay::Field,
                                       .swatches = nullptr,
                                       .region = nullptr,
                                       .field = made->field,
                                       .contours = false};
}

}  // namespace

const FemScale& scale_of(FemMeasure measure) {
  static const std::array<FemScale, 3> kScales = {
      {{"Volume ratio, det F", "", 0.5, 2, true, {0.5, 0.7, 1, 1.4, 2}},
       {"Strain energy density", "kPa", 0.001, 10, true, {0.001, 0.01, 0.1, 1, 10}},
       {"Gap where skin meets skin", "mm", 0, 4, false, {0, 1, 2, 3, 4}}}};
  return kScales[static_cast<std::size_t>(measure)];
}

double place_on(const FemScale& scale, double value) {
  const double place = !scale.ratio         ? (value - scale.low) / (scale.high - scale.low)
                       : value <= scale.low ? 0
                                            : std::log(value / scale.low) / std::log(scale.high / scale.low);
  return std::clamp(place, 0.0, 1.0);
}

glm::vec3 colour_at(FemMeasure measure, double place) {
  // The colour scale of contact gaps is reversed: a smaller gap gets a brighter colour, so that skin that presses on
  // skin stands out.
  return measure == FemMeasure::VolumeRatio
             ? between(kChange, place)
             : between(render::kWeightRamp, measure == FemMeasure::Gap ? 1 - place : place);
}

glm::vec3 colour_of(FemMeasure measure, float value) {
  if (std::isnan(value) || (measure == FemMeasure::Gap && std::isinf(value))) return render::kExactZero;
  return colour_at(measure, place_on(scale_of(measure), value));
}

std::string text_of(FemMeasure measure, float value) {
  if (std::isnan(value)) return "joint";
  if (std::isinf(value)) return measure == FemMeasure::Gap ? "none near" : "inverted";
  if (measure == FemMeasure::EnergyDensity && value < scale_of(measure).low) return "0";
  char text[32];
  std::snprintf(text, sizeof text,
                measure != FemMeasure::EnergyDensity ? "%.2f"
                : value < 10                         ? "%.2g"
                                                     : "%.0f",
                double(value));
  return text;
}

std::string range_text(const MeasuredMesh& shown) {
  const std::string least = text_of(*shown.measure, shown.least), most = text_of(*shown.measure, shown.most);
  if (shown.least > shown.most) return "";  // no soft tissue was measured
  if (*shown.measure == FemMeasure::Gap) return std::isinf(shown.least) ? "no contact" : "from " + least;
  return *shown.measure == FemMeasure::EnergyDensity ? "up to " + most : least + " \u2013 " + most;
}

std::string why_no_fem_overlay(const Context& context) {
  if (context.workspace() != Workspace::Resample && context.workspace() != Workspace::Pose)
    return "Switch to the Resample or Pose workspace first";
  if (shown_mesh(context, false) || (comparing(context) && shown_mesh(context, true))) return "";
  const auto& results = context.document().results;
  if (std::none_of(results.begin(), results.end(), [](const auto& result) { return result->solved != nullptr; }))
    return "Resample by FEM first";
  return "Show a FEM result first";
}

void show_fem(Context& context) {
  const FemOverlay& overlay = *context.fem_overlay;
  Views& views = *context.views;
  views.scene.mesh.reset();
  if (views.other_scene) views.other_scene->mesh.reset(), views.other_scene->weights.reset();
  if (!overlay.measure && !overlay.tets) return;
  if (const auto mesh = shown_mesh(context, false)) put_into(context, views.scene, *mesh);
  if (!views.other_scene) return;
  if (const auto mesh = shown_mesh(context, true)) put_into(context, *views.other_scene, *mesh);
}

const MeasuredMesh* shown_measure(const Context& context) {
  const Views& views = *context.views;
  const MeasuredMesh* shown = measured_in(context.fem_overlay, views.scene);
  return shown || !views.other_scene ? shown : measured_in(context.fem_overlay, *views.other_scene);
}

std::string measure_text_at(const Context& context, const glm::ivec3& voxel) {
  const ViewPlace* view = hovered_view(context);
  const MeasuredMesh* shown =
      measured_in(context.fem_overlay, view ? scene_at_pointer(context, *view) : context.views->scene);
  if (!shown || !shown->of.volume->grid.contains(voxel)) return "";
  const std::int64_t place = shown->tissue->index_of(voxel);
  if (place < 0) return "";
  const std::int32_t tet = (*shown->tets)[static_cast<std::size_t>(place)];
  constexpr const char* kShort[] = {"det F ", "energy ", "gap "};
  const float value = tet < 0 ? measure_at_rest(*shown->measure) : shown->values[static_cast<std::size_t>(tet)];
  const std::string& unit = scale_of(*shown->measure).unit;
  return kShort[static_cast<int>(*shown->measure)] + text_of(*shown->measure, value) +
         (unit.empty() || !std::isfinite(value) ? "" : " " + unit);
}

}  // namespace limber::editor
