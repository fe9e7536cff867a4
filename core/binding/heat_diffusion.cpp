// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_diffusion.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/binding/cell_heat.h"
#include "core/binding/cell_interpolation.h"
#include "core/binding/chest_reach.h"
#include "core/binding/cover_islands.h"
#include "core/binding/flesh_graph.h"
#include "core/binding/joint_heat.h"
#include "core/binding/voxel_heat.h"
#include "core/platform/large_blocks.h"

namespace limber {

namespace {
// A bone is solved for only in bricks (8^3 voxels) where the coarse solution gives it a larger weight than this. With
// this weight, a bone that turns by 60 degrees moves a point 300 mm from the joint by only 0.1 mm.
constexpr float kNegligible = 3e-4f;
constexpr double kCoarseResidual = 1e-4;
// A block (a group of bones that are solved together) gets no further bone that would need more memory than this, in
// bytes per tissue voxel of the body.
constexpr double kBlockBytes = 16;

// The coarse solution: each bone's temperature in the coarse cells, without values up to kNegligible.
struct CoarseTemperatures {
  struct Entry {
    std::int32_t cell;
    float value;
  };
  std::vector<std::vector<Entry>> by_bone;
};

void fill_sources(const std::vector<HeldFace>& held, const std::vector<int>& lane_of_bone, int lanes,
                  ZeroedVector<float>& b) {
  for (const HeldFace& face : held)
    if (const int lane = lane_of_bone[face.bone]; lane >= 0)
      b[std::int64_t{face.cell} * lanes + lane] += face.conductance;
}

// Returns for each cell whether heat from at least one bone reaches it.
std::vector<bool> reached_cells(const CellGraph& graph, const std::vector<HeldFace>& held) {
  std::vector<bool> reached(graph.size(), false);
  std::vector<std::int32_t> open;
  auto reach = [&](std::int32_t cell) {
    if (reached[cell]) return;
    reached[cell] = true;
    open.push_back(cell);
  };
  for (const HeldFace& face : held) reach(face.cell);
  while (!open.empty()) {
    const std::int32_t cell = open.back();
    open.pop_back();
    for (std::int32_t k = graph.first[cell]; k < graph.first[cell + 1]; ++k) reach(graph.neighbour[k]);
  }
  return reached;
}

CoarseTemperatures solve_coarse(const HeatGraph::Coarse& coarse, const std::vector<bool>& reached, int bone_count) {
  // Cells that no heat reaches get temperature zero: an additional heat loss there keeps the system solvable.
  CellGraph graph = coarse.graph;
  for (std::int64_t i = 0; i < graph.size(); ++i)
    if (!reached[i]) graph.diagonal[i] += 1;
  const std::int64_t size = graph.size();
  const Multigrid multigrid(std::move(graph));

  std::vector<bool> holds(bone_count, false);
  for (const HeldFace& face : coarse.held) holds[face.bone] = true;
  CoarseTemperatures temperatures;
  temperatures.by_bone.resize(bone_count);
  std::vector<int> lane_of_bone(bone_count, -1), block;
  for (int bone = 0; bone <= bone_count; ++bone) {
    if (bone < bone_count && holds[bone]) {
      lane_of_bone[bone] = static_cast<int>(block.size());
      block.push_back(bone);
    }
    if (block.empty() || (bone < bone_count && std::ssize(block) < Multigrid::kMostLanes)) continue;
    const int lanes = static_cast<int>(block.size());
    ZeroedVector<float> b(size * lanes), x(size * lanes);
    fill_sources(coarse.held, lane_of_bone, lanes, b);
    multigrid.solve(std::move(b), x, lanes, kCoarseResidual, 100);
    for (int lane = 0; lane < lanes; ++lane) {
      for (std::int64_t c = 0; c < size; ++c)
        if (x[c * lanes + lane] > kNegligible)
          temperatures.by_bone[block[lane]].push_back({static_cast<std::int32_t>(c), x[c * lanes + lane]});
      lane_of_bone[block[lane]] = -1;
    }
    block.clear();
  }
  return temperatures;
}

// Returns for each bone the bricks in which the coarse solution gives the bone weight, ascending.
std::vector<std::vector<std::int32_t>> bricks_of_bones(const CoarseTemperatures& temperatures,
                                                       const std::vector<std::int32_t>& brick_of_cell) {
  std::vector<std::vector<std::int32_t>> bricks(temperatures.by_bone.size());
  parallel_for(std::ssize(bricks), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t bone = begin; bone < end; ++bone) {
      for (const auto& entry : temperatures.by_bone[bone]) bricks[bone].push_back(brick_of_cell[entry.cell]);
      std::sort(bricks[bone].begin(), bricks[bone].end());
      bricks[bone].erase(std::unique(bricks[bone].begin(), bricks[bone].end()), bricks[bone].end());
    }
  });
  return bricks;
}

}  // namespace

SkinWeights diffuse_heat(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                         const HeatDiffusion& settings, Progress& progress, WeightsReport* report) {
  const TissueVoxels tissue(volume);
  const BoneParts parts = split_bones(volume, tissue, tissues, armature, progress);
  return diffuse_heat(volume, tissue, tissues, armature, parts, settings, progress, report);
}

namespace {
// Computes weights by solving for the temperature of every voxel.
void diffuse_in_voxels(const HeatBody& body, const HeatDiffusion& settings, Progress& progress, BestFour& best,
                       WeightsReport& said) {
  const int bone_count = static_cast<int>(body.armature.bones.size());
  const NearestBone nearest = attracting_bone(body.volume, body.tissue, body.armature, body.held_by);
  const HeatGraph heat(body.volume, body.tissue, body.tissues, body.held_by, nearest, settings.stiffness);
  const HeatGraph::Coarse coarse = heat.coarse();
  const std::vector<bool> reached = reached_cells(coarse.graph, coarse.held);
  const CoarseTemperatures temperatures = solve_coarse(coarse, reached, bone_count);
  progress.update("weights", 0.2);

  return_free_memory();
  const std::vector<BoneBlock> blocks = blocks_of_bones(bricks_of_bones(temperatures, coarse.brick),
                                                        HeatVectors::bytes_of_brick, kBlockBytes * body.tissue.size());
  std::vector<float> guess(coarse.graph.size() * kMostBonesTogether, 0.0f);
  KnownHeat known;
  known.start_block = [&](const std::vector<int>& bones) {
    std::fill(guess.begin(), guess.end(), 0.0f);
    for (std::size_t lane = 0; lane < bones.size(); ++lane)
      for (const auto& entry : temperatures.by_bone[bones[lane]])
        guess[std::int64_t{entry.cell} * kMostBonesTogether + lane] = entry.value;
  };
  known.is_reached = [&](std::int64_t, std::int64_t place) { return reached[coarse.cell_of_place[place]]; };
  known.first_guess = [&](std::int64_t, std::int64_t place, int lane) {
    return guess[std::int64_t{coarse.cell_of_place[place]} * kMostBonesTogether + lane];
  };
  solve_in_voxels(heat, body, blocks, known, settings, {0.2, 0.95}, progress, best, said);
}

// Computes weights by solving for the temperatures of cells of several voxels and interpolating them to voxels. Only
// between bones that are near to each other, the temperatures of single voxels are solved for.
void diffuse_in_cells(const HeatBody& body, const HeatDiffusion& settings, const glm::i16vec3& shift,
                      Progress& progress, BestFour& best, WeightsReport& said) {
  const HeatLaw law(body.volume.grid, body.tissues, settings.stiffness);
  const BrickWindow::Source source{body.volume, body.tissue, body.held_by, law.conductivity};
  HeatCells cells = make_heat_cells(source, law, shift);
  progress.update("weights", 0.1);
  const std::vector<BoneReach> reaches = reaches_in_body(body.volume.grid, body.tissue, body.armature, body.held_by);
  const std::vector<CellPath> paths = paths_to_cells(body.volume.grid, body.tissue, cells, reaches);
  progress.update("weights", 0.2);
  const double block_bytes = kBlockBytes * body.tissue.size();
  const CellTemperatures temperatures =
      solve_cells(cells, sources_of_bones(source, law, body.armature, paths, reaches, cells), body.armature, settings,
                  block_bytes, {0.2, 0.7}, progress, said);
  const std::vector<std::int32_t> joints = bricks_between_bones(body.tissue, body.held_by, shift);
  interpolate_cells(body.tissue, cells, joints, temperatures, best);
  progress.update("weights", 0.8);
  solve_joints(body, settings, joints, {cells, paths, temperatures}, block_bytes, {0.8, 0.95}, progress, best, said);
}
}  // namespace

SkinWeights diffuse_heat(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const Armature& armature, const BoneParts& parts, const HeatDiffusion& settings,
                         Progress& progress, WeightsReport* report) {
  WeightsReport ignored;
  WeightsReport& said = report ? *report : ignored;
  progress.update("weights", 0);
  return_free_memory();  // frees the memory left over from splitting bones and finding seams
  const ZeroedVector<std::uint16_t> held_by = fixed_bone(volume, tissue, parts, armature);
  const HeatBody body{volume, tissue, tissues, armature, held_by};
  BestFour best(tissue);
  const glm::i16vec3 shift = shift_of_cells(volume.grid, tissue.size(), settings.most_cells);
  if (shift == glm::i16vec3(0)) diffuse_in_voxels(body, settings, progress, best, said);
  else diffuse_in_cells(body, settings, shift, progress, best, said);
  best.hold_all(held_by, kSoft);
  cover_islands(volume, tissue, armature, best, said, &tissues);
  return best.weights(names_of_bones(armature));
}

}  // namespace limber
