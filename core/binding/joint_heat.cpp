// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/joint_heat.h"

#include <algorithm>
#include <limits>

#include "core/base/parallel.h"
#include "core/binding/chest_reach.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop
// A bone is solved for only in bricks (8^3 voxels) where the solution in cells gives it a larger weight than this. With
// this weight, a bone that turns by 60 degrees moves a point 300 mm from the joint by only 0.1 mm.
constexpr float kNegligible = 3e-4f;

// The bones that hold voxels in or near a brick: none, one or several.
struct NearBones {
  std::uint16_t lowest = kSoft, highest = 0;  // lowest and highest index of the bones; lowest > highest: no bone
  void add(const NearBones& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
  }
  bool are_several() const { return lowest < highest; }
};

// Returns, for each brick, the bones near the brick or near one of its neighbours.
std::vector<NearBones> spread(const std::vector<NearBones>& near, const TissueVoxels& tissue) {
  const glm::ivec3 size = tissue.grid_size();
  std::vector<NearBones> wider(near);
  parallel_for(std::ssize(near), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick)
      for (int k = 0; k < 27; ++k) {
        const glm::ivec3 at =
            tissue.bricks()[brick].corner + TissueVoxels::kBrick * glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, size))) continue;
        if (const int other = tissue.brick_at(at); other >= 0) wider[brick].add(near[other]);
      }
  });
  return wider;
}

float temperature_of(const CellTemperatures& temperatures, std::int32_t cell, int bone) {
  for (std::int64_t e = temperatures.first[cell]; e < temperatures.first[cell + 1]; ++e)
    if (temperatures.entries[e].bone == bone) return temperatures.entries[e].value;
  return 0;
}

// Returns for each bone those of the given bricks in which the solution in cells gives the bone weight, ascending.
std::vector<std::vector<std::int32_t>> bricks_with_weight(const std::vector<std::int32_t>& bricks,
                                                          const SolvedCells& solved, std::size_t bone_count) {
  std::vector<std::vector<std::int32_t>> of_bones(bone_count);
  for (const std::int32_t brick : bricks)
    for (std::int32_t number = 0; number < solved.cells.cell_count(brick); ++number) {
      const std::int32_t cell = solved.cells.cell(brick, number);
      for (std::int64_t e = solved.temperatures.first[cell]; e < solved.temperatures.first[cell + 1]; ++e) {
        const CellTemperatures::Entry& entry = solved.temperatures.entries[e];
        std::vector<std::int32_t>& own = of_bones[entry.bone];
        if (entry.value > kNegligible && (own.empty() || own.back() != brick)) own.push_back(brick);
      }
    }
  return of_bones;
}

// Returns the nearest bone of the voxels in some bricks, along the paths to their cells. Other voxels keep no nearest
// bone.
NearestBone nearest_along_paths(const HeatBody& body, const std::vector<std::int32_t>& bricks,
                                const SolvedCells& solved) {
  const std::vector<BoneReach> reaches = reaches_in_body(body.volume.grid, body.tissue, body.armature, body.held_by);
  const PathsToVoxels paths(body.volume.grid, solved.cells, solved.paths, body.armature, reaches);
  NearestBone nearest;
  nearest.bone.resize(body.tissue.size());
  nearest.distance.resize(body.tissue.size());
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::vector<CellPath>> listed;
    for (std::int64_t b = begin; b < end; ++b) {
      listed.resize(solved.cells.cell_count(bricks[b]));
      for (std::int32_t number = 0; number < std::ssize(listed); ++number)
        paths.list(solved.cells.cell(bricks[b], number), listed[number]);
      body.tissue.for_each(bricks[b], bricks[b] + 1, [&](std::int64_t place, const glm::ivec3& v) {
        nearest.bone[place] = kSoft;
        nearest.distance[place] = std::numeric_limits<float>::infinity();
        const std::uint16_t number = solved.cells.number_in_brick[place];
        if (number == HeatCells::kNoCell || listed[number].empty()) return;
        const PathsToVoxels::Nearest found = paths.nearest(listed[number], v);
        nearest.bone[place] = found.bone;
        nearest.distance[place] = found.distance;
      });
    }
  });
  return nearest;
}
}  // namespace

std::vector<std::int32_t> bricks_between_bones(const TissueVoxels& tissue, const ZeroedVector<std::uint16_t>& held_by,
                                               const glm::i16vec3& shift) {
  std::vector<NearBones> near(tissue.bricks().size());
  parallel_for(std::ssize(near), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick)
      tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3&) {
        if (const std::uint16_t bone = held_by[place]; bone != kSoft) near[brick].add({bone, bone});
      });
  });
  const int rings = 1 << (std::max({shift.x, shift.y, shift.z}) - 1);
  for (int ring = 0; ring < rings; ++ring) near = spread(near, tissue);
  std::vector<std::int32_t> bricks;
  for (std::int32_t brick = 0; brick < std::ssize(near); ++brick)
    if (near[brick].are_several()) bricks.push_back(brick);
  return bricks;
}

void solve_joints(const HeatBody& body, const HeatDiffusion& settings, const std::vector<std::int32_t>& bricks,
                  const SolvedCells& solved, double most_bytes, const ShareOfProgress& share, Progress& progress,
                  BestFour& best, WeightsReport& report) {
  const NearestBone nearest = nearest_along_paths(body, bricks, solved);
  const HeatGraph heat(body.volume, body.tissue, body.tissues, body.held_by, nearest, settings.stiffness);
  const std::vector<BoneBlock> blocks = blocks_of_bones(bricks_with_weight(bricks, solved, body.armature.bones.size()),
                                                        HeatVectors::bytes_of_brick, most_bytes);
  const auto cell_of = [&](std::int64_t brick, std::int64_t place) {
    return solved.cells.cell(brick, solved.cells.number_in_brick[place]);
  };
  std::vector<int> bones;
  KnownHeat known;
  known.start_block = [&](const std::vector<int>& of_block) { bones = of_block; };
  known.is_reached = [&](std::int64_t brick, std::int64_t place) {
    const std::int32_t cell = cell_of(brick, place);
    return solved.temperatures.first[cell] < solved.temperatures.first[cell + 1];
  };
  known.first_guess = [&](std::int64_t brick, std::int64_t place, int lane) {
    return temperature_of(solved.temperatures, cell_of(brick, place), bones[lane]);
  };
  known.outside = [&](std::int64_t brick, std::int64_t place, int lane) {
    // The block's bones have no weight in those of `bricks`, the bricks between bones, in which the block is not
    // solved.
    if (std::binary_search(bricks.begin(), bricks.end(), static_cast<std::int32_t>(brick))) return 0.0f;
    return best.weight(brick, place, bones[lane]);
  };
  solve_in_voxels(heat, body, blocks, known, settings, share, progress, best, report);
}

}  // namespace limber
