// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/measure/measure_view.h"

#include <algorithm>
#include <cctype>

#include "core/deform/carried_points.h"
#include "core/deform/preview_map.h"
#include "core/deform/skinning.h"
#include "core/resample/fem_steps.h"
#include "core/resample/posed_points.h"
#include "core/skin/weight_at.h"
#include "editor/context/document_edits.h"
#include "editor/shown/preview_blend.h"

namespace limber::editor {

namespace {

constexpr std::size_t kRemembered = 4;
constexpr double kBesideMesh = 10;  // largest distance from a solved mesh at which a point moves with it, mm

// Returns points of the body in the pose that a scene previews. Each point moves as the tissue around it.
std::vector<glm::dvec3> previewed(Editor& editor, const render::Scene& scene, const std::vector<glm::dvec3>& at_rest) {
  const Document& document = editor.document();
  const SkinWeights& weights = *document.weights;
  std::vector<RigidTransform> motions;
  for (const std::string& name : weights.bones()) {
    const auto bone = scene.armature->find(name);
    const bool is_posed = bone && *bone < std::ssize(scene.posed_from_rest);
    motions.push_back(is_posed ? scene.posed_from_rest[static_cast<std::size_t>(*bone)] : RigidTransform{});
  }
  const std::vector<SkinTransform> transforms = skin_transforms(motions);
  const Blend blend = preview_blend(editor);
  const auto skin = skin_at(*document.volume, *tissue_voxels(*editor.views, document), weights, at_rest);
  std::vector<glm::dvec3> posed;
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    std::vector<limber::BoneWeight> influences;
    for (int k = 0; k < 4; ++k)
      if (skin[i].influence.weight[k] > 0)
        influences.push_back({skin[i].influence.bone[k], skin[i].influence.weight[k] / double(kFullWeight)});
    posed.push_back(blend_point(blend, transforms, influences, at_rest[i]));
  }
  return posed;
}

// Returns points of the body as a result poses it.
std::vector<glm::dvec3> in_result(Editor& editor, const Result& result, const std::vector<glm::dvec3>& at_rest) {
  if (!result.from_volume || !result.from_weights || !result.from_armature || !result.from_pose || !result.from_tissues)
    return at_rest;
  const Document& document = editor.document();
  const auto tissue = result.from_volume == document.volume ? tissue_voxels(*editor.views, document)
                                                            : std::make_shared<const TissueVoxels>(*result.from_volume);
  const Blend blend = find_blend(result.method).value_or(Blend::DualQuaternion);
  std::vector<glm::dvec3> posed = posed_points(*result.from_volume, *tissue, *result.from_tissues, *result.from_weights,
                                               *result.from_armature, *result.from_pose, blend, nullptr, at_rest);
  if (!result.solved) return posed;
  // Where a solved mesh moves the flesh, the points go with it. Points in bone keep the motion of their bone.
  const Grid& grid = result.from_volume->grid;
  const AffineTransform to_voxel = voxel_from_world(grid), to_world = world_from_voxel(grid);
  std::vector<PointToCarry> rest;
  for (const glm::dvec3& point : at_rest) rest.push_back({to_voxel * point, to_voxel * point});
  const auto mesh = std::shared_ptr<const TetMesh>(result.solved, &result.solved->mesh.tets);
  const auto carried = CarriedPoints(mesh, grid, rest, kBesideMesh).posed(result.solved->V);
  for (std::size_t i = 0; i < posed.size(); ++i) {
    const Label label = result.from_volume->at_or_air(glm::ivec3(glm::floor(rest[i].rest + 0.5)));
    const Tissue* at = result.from_tissues->find(label);
    if (carried[i] && !(at && is_bone(at->kind))) posed[i] = to_world * *carried[i];
  }
  return posed;
}

const Result* result_of(const Document& document, const render::Scene& scene) {
  for (const auto& result : document.results)
    if (result->volume == scene.volume) return result.get();
  return nullptr;
}

bool is_previewed(const Document& document, const render::Scene& scene) {
  return scene.volume == document.volume && scene.pose && scene.armature && document.weights;
}

}  // namespace

std::vector<glm::dvec3> points_on_scene(Editor& editor, const render::Scene& scene,
                                        const std::vector<glm::dvec3>& at_rest) {
  if (at_rest.empty()) return {};
  if (is_previewed(editor.document(), scene)) return previewed(editor, scene, at_rest);
  if (const Result* result = result_of(editor.document(), scene)) return in_result(editor, *result, at_rest);
  return at_rest;
}

std::optional<glm::dvec3> point_at_rest(const render::Scene& scene, const glm::dvec3& world) {
  if (!scene.volume) return std::nullopt;
  if (!scene.pose) return world;
  const auto rest = scene.pose->rest_at(voxel_from_world(scene.volume->grid) * world);
  if (!rest) return std::nullopt;
  return world_from_voxel(scene.volume->grid) * *rest;
}

const std::vector<std::vector<glm::dvec3>>& placed_measurements(Editor& editor, const render::Scene& scene) {
  MeasureView& view = *editor.measures;
  const Document& document = editor.document();
  const auto known = std::find_if(view.placed.begin(), view.placed.end(), [&](const MeasureView::Placed& placed) {
    return placed.of == document.measurements && placed.volume == scene.volume;
  });
  // A preview changes with every frame of a drag, and its points are quickly moved.
  const bool is_kept = !is_previewed(document, scene);
  if (known != view.placed.end() && is_kept) return known->points;
  if (known != view.placed.end()) view.placed.erase(known);
  MeasureView::Placed placed{document.measurements, scene.volume, {}};
  std::vector<glm::dvec3> all;
  for (const Measurement& one : *document.measurements) all.insert(all.end(), one.points.begin(), one.points.end());
  all = points_on_scene(editor, scene, all);
  auto next = all.begin();
  for (const Measurement& one : *document.measurements) {
    const auto end = next + std::ssize(one.points);
    placed.points.emplace_back(next, end);
    next = end;
  }
  if (!is_kept) placed.volume = nullptr;  // so that no later frame takes it for the body at rest
  if (view.placed.size() >= kRemembered) view.placed.erase(view.placed.begin());
  view.placed.push_back(std::move(placed));
  return view.placed.back().points;
}

void add_measurement(Editor& editor, MeasureKind kind, std::vector<glm::dvec3> points) {
  Document next = editor.document();
  Measurements all = next.measurements ? *next.measurements : Measurements{};
  std::string word(word_of(kind));
  word[0] = static_cast<char>(std::toupper(word[0]));
  const auto is_taken = [&](const std::string& name) {
    return std::any_of(all.begin(), all.end(), [&](const Measurement& one) { return one.name == name; });
  };
  int number = 1;
  while (is_taken(word + " " + std::to_string(number))) ++number;
  const std::string name = word + " " + std::to_string(number);
  all.push_back({name, kind, std::move(points)});
  next.measurements = std::make_shared<const Measurements>(std::move(all));
  commit(editor, "Measure " + std::string(word_of(kind)), std::move(next));
  editor.measures->chosen = name;
  editor.measures->shown = true;
}

std::optional<std::size_t> chosen_measurement(const Editor& editor) {
  const auto& all = editor.document().measurements;
  if (!all) return std::nullopt;
  for (std::size_t i = 0; i < all->size(); ++i)
    if ((*all)[i].name == editor.measures->chosen) return i;
  return std::nullopt;
}

std::string table_of_measurements(Editor& editor) {
  std::string table = "name\tkind\tat rest\tas shown\tunit\n";
  const auto& all = editor.document().measurements;
  if (!all) return table;
  const auto& placed = placed_measurements(editor, editor.views->scene);
  for (std::size_t i = 0; i < all->size(); ++i) {
    const Measurement& one = (*all)[i];
    char values[80];
    std::snprintf(values, sizeof values, "%.3f\t%.3f", measure(one.kind, one.points), measure(one.kind, placed[i]));
    table += one.name + "\t" + std::string(word_of(one.kind)) + "\t" + values + "\t" +
             (one.kind == MeasureKind::Angle ? "degrees" : "mm") + "\n";
  }
  return table;
}

}  // namespace limber::editor
