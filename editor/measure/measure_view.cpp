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
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/views.h"
#include "editor/shown/preview_blend.h"

namespace limber::editor {

namespace {

constexpr std::size_t kRemembered = 4;
// A point farther than this from a FEM result's mesh does not move with the mesh, mm.
constexpr double kBesideMesh = 10;

// Returns the positions of points of the rest body in the pose that a scene previews. Each point moves with the tissue
// around it.
std::vector<glm::dvec3> previewed(Context& context, const render::Scene& scene,
                                  const std::vector<glm::dvec3>& at_rest) {
  const Document& document = context.document();
  const SkinWeights& weights = *document.weights;
  std::vector<RigidTransform> motions;
  for (const std::string& name : weights.bones()) {
    const auto bone = scene.armature->find(name);
    const bool is_posed = bone && *bone < std::ssize(scene.posed_from_rest);
    motions.push_back(is_posed ? scene.posed_from_rest[static_cast<std::size_t>(*bone)] : RigidTransform{});
  }
  const std::vector<SkinTransform> transforms = skin_transforms(motions);
  const Blend blend = preview_blend(context.resampling);
  const auto skin = skin_at(*document.volume, *tissue_voxels(*context.views, document), weights, at_rest);
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

// Returns the positions of points of the rest body in the posed body of a result.
std::vector<glm::dvec3> in_result(Context& context, const Result& result, const std::vector<glm::dvec3>& at_rest) {
  if (!result.from_volume || !result.from_weights || !result.from_armature || !result.from_pose || !result.from_tissues)
    return at_rest;
  if (result.from_pose->rotation.size() != result.from_armature->bones.size()) return at_rest;
  const Document& document = context.document();
  const auto tissue = result.from_volume == document.volume ? tissue_voxels(*context.views, document)
                                                            : std::make_shared<const TissueVoxels>(*result.from_volume);
  // In a damaged project, the weights may not match the rig or the volume. The points then stay at rest.
  const auto& bones = result.from_weights->bones();
  const bool has_bones = std::all_of(bones.begin(), bones.end(), [&](const std::string& bone) {
    return result.from_armature->find(bone).has_value();
  });
  if (!has_bones || result.from_weights->chunk_count() != std::ssize(tissue->bricks())) return at_rest;
  const Blend blend = find_blend(result.method).value_or(Blend::DualQuaternion);
  std::vector<glm::dvec3> posed = posed_points(*result.from_volume, *tissue, *result.from_tissues, *result.from_weights,
                                               *result.from_armature, *result.from_pose, blend, nullptr, at_rest);
  if (!result.solved) return posed;
  // In a FEM result, points in soft tissue move with the solved mesh. Points in bone move with their bone.
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

bool is_at_tissue(const LabelVolume& volume, const glm::dvec3& at_rest) {
  constexpr int kReach = 2;
  const glm::dvec3 place = voxel_from_world(volume.grid) * at_rest;
  if (!(glm::all(glm::greaterThan(place, glm::dvec3(-kReach - 1))) &&
        glm::all(glm::lessThan(place, glm::dvec3(volume.grid.size + kReach)))))
    return false;
  const glm::ivec3 voxel(glm::floor(place + 0.5));
  for (int z = -kReach; z <= kReach; ++z)
    for (int y = -kReach; y <= kReach; ++y)
      for (int x = -kReach; x <= kReach; ++x)
        if (volume.at_or_air(voxel + glm::ivec3(x, y, z)) != 0) return true;
  return false;
}

std::vector<glm::dvec3> points_on_scene(Context& context, const render::Scene& scene,
                                        const std::vector<glm::dvec3>& at_rest) {
  const Document& document = context.document();
  const bool is_preview = is_previewed(document, scene);
  const Result* result = is_preview ? nullptr : result_of(document, scene);
  const LabelVolume* volume = is_preview ? document.volume.get() : result ? result->from_volume.get() : nullptr;
  if (!volume) return at_rest;
  std::vector<glm::dvec3> moving;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < at_rest.size(); ++i)
    if (is_at_tissue(*volume, at_rest[i])) moving.push_back(at_rest[i]), which.push_back(i);
  if (moving.empty()) return at_rest;
  moving = is_preview ? previewed(context, scene, moving) : in_result(context, *result, moving);
  std::vector<glm::dvec3> posed = at_rest;
  for (std::size_t k = 0; k < which.size(); ++k) posed[which[k]] = moving[k];
  return posed;
}

std::optional<glm::dvec3> point_at_rest(const render::Scene& scene, const glm::dvec3& world) {
  if (!scene.volume) return std::nullopt;
  if (!scene.pose) return world;
  const auto rest = scene.pose->rest_at(voxel_from_world(scene.volume->grid) * world);
  if (!rest) return std::nullopt;
  return world_from_voxel(scene.volume->grid) * *rest;
}

std::vector<std::vector<glm::dvec3>> placed_measurements(Context& context, const render::Scene& scene) {
  const Measurements& measurements = *context.document().measurements;
  std::vector<glm::dvec3> at_rest;
  for (const Measurement& one : measurements) at_rest.insert(at_rest.end(), one.points.begin(), one.points.end());
  // Points of a previewed pose are computed in every frame: this is fast, and a drag changes the pose in every frame.
  // Points of results are cached.
  std::vector<MeasureView::Placed>& placed = context.measures->placed;
  std::vector<glm::dvec3> posed;
  if (!result_of(context.document(), scene)) {
    posed = points_on_scene(context, scene, at_rest);
  } else if (const auto known = std::find_if(placed.begin(), placed.end(),
                                             [&](const MeasureView::Placed& one) {
                                               return one.volume.lock() == scene.volume && one.at_rest == at_rest;
                                             });
             known != placed.end()) {
    posed = known->posed;
  } else {
    posed = points_on_scene(context, scene, at_rest);
    if (placed.size() >= kRemembered) placed.erase(placed.begin());
    placed.push_back({scene.volume, at_rest, posed});
  }
  std::vector<std::vector<glm::dvec3>> points;
  auto next = posed.begin();
  for (const Measurement& one : measurements) {
    const auto end = next + std::ssize(one.points);
    points.emplace_back(next, end);
    next = end;
  }
  return points;
}

void add_measurement(Context& context, MeasureKind kind, std::vector<glm::dvec3> points) {
  Document next = context.document();
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
  commit(context, "Measure " + std::string(word_of(kind)), std::move(next));
  context.measures->chosen = name;
  context.measures->shown = true;
}

std::optional<std::size_t> chosen_measurement(const Context& context) {
  const auto& all = context.document().measurements;
  if (!all) return std::nullopt;
  for (std::size_t i = 0; i < all->size(); ++i)
    if ((*all)[i].name == context.measures->chosen) return i;
  return std::nullopt;
}

std::string table_of_measurements(Context& context) {
  std::string table = "name\tkind\tat rest\tas shown\tunit\n";
  const auto& all = context.document().measurements;
  if (!all) return table;
  const auto placed = placed_measurements(context, context.views->scene);
  for (std::size_t i = 0; i < all->size(); ++i) {
    const Measurement& one = (*all)[i];
    char values[80];
    std::snprintf(values, sizeof values, "%.3f\t%.3f", measure(one.kind, one.points), measure(one.kind, placed[i]));
    std::string name = one.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '\t' || c == '\n'; }, ' ');
    table += name + "\t" + std::string(word_of(one.kind)) + "\t" + values + "\t" +
             (one.kind == MeasureKind::Angle ? "degrees" : "mm") + "\n";
  }
  return table;
}

}  // namespace limber::editor
