// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/cover_islands.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 256;  // bricks per block of a parallel loop

// Returns the blocks of bricks that contain a voxel without a bone, in ascending order.
std::vector<std::int64_t> blocks_with_uncovered(const TissueVoxels& tissue, const BestFour& best) {
  const auto bricks = std::ssize(tissue.bricks());
  std::vector<std::uint8_t> has_uncovered((bricks + kGrain - 1) / kGrain);
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::uint8_t& found = has_uncovered[begin / kGrain];
    tissue.for_each(begin, end, [&](std::int64_t place, const glm::ivec3& v) {
      found |= !best.covered(tissue.brick_at(v), place);
    });
  });
  std::vector<std::int64_t> blocks;
  for (std::int64_t block = 0; block < std::ssize(has_uncovered); ++block)
    if (has_uncovered[block]) blocks.push_back(block);
  return blocks;
}

// Returns how a warning names the tissue with a label: by its name, or else by the label that it has in files.
std::string tissue_in_words(const Tissue* tissue, Label label) {
  if (tissue && !tissue->name.empty()) return tissue->name;
  char text[48];
  std::snprintf(text, sizeof text, "label %.15g", tissue ? tissue->file_value : double(label));
  return text;
}
}  // namespace

void cover_islands(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature, BestFour& best,
                   WeightsReport& report, const TissueTable* tissues) {
  struct Island {
    std::int64_t voxels;
    std::string tissue;  // name of the tissue of the component's first voxel; without a name, its label in files
    glm::dvec3 centre;
    int bone;
  };
  std::vector<Island> islands;
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  std::vector<std::pair<std::int64_t, glm::ivec3>> piece;
  const auto cover_from = [&](std::int64_t seed, const glm::ivec3& seed_voxel) {
    if (best.covered(tissue.brick_at(seed_voxel), seed)) return;
    // Gives each voxel of this connected component to bone 0 for now. This marks the voxel as visited until the bone
    // nearest to the whole component is known.
    piece.assign(1, {seed, seed_voxel});
    best.hold(tissue.brick_at(seed_voxel), seed, 0);
    glm::dvec3 sum(0);
    for (size_t k = 0; k < piece.size(); ++k) {
      const glm::ivec3 v = piece[k].second;
      sum += glm::dvec3(v);
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        if (volume.at_or_air(w) == 0) continue;
        const std::int64_t place = tissue.index_of(w);
        const int brick = tissue.brick_at(w);
        if (best.covered(brick, place)) continue;
        best.hold(brick, place, 0);
        piece.push_back({place, w});
      }
    }
    const Tissue* label = tissues ? tissues->find(volume.at(seed_voxel)) : nullptr;
    Island island{std::ssize(piece), tissue_in_words(label, volume.at(seed_voxel)),
                  from_voxel * (sum / double(piece.size())), 0};
    double nearest = std::numeric_limits<double>::max();
    for (size_t b = 0; b < armature.bones.size(); ++b)
      if (const double d = distance_to_bone(armature.bones[b], island.centre); d < nearest)
        nearest = d, island.bone = static_cast<int>(b);
    for (const auto& [place, voxel] : piece) best.hold(tissue.brick_at(voxel), place, island.bone);
    islands.push_back(island);
  };
  for (const std::int64_t block : blocks_with_uncovered(tissue, best))
    tissue.for_each(block * kGrain, std::min((block + 1) * kGrain, std::ssize(tissue.bricks())), cover_from);

  std::stable_sort(islands.begin(), islands.end(),
                   [](const Island& a, const Island& b) { return a.voxels > b.voxels; });
  constexpr size_t kMostLines = 5;
  for (size_t k = 0; k < std::min(islands.size(), kMostLines); ++k) {
    const Island& island = islands[k];
    char text[256];
    std::snprintf(text, sizeof text, "no bone reaches %lld %s of %.80s near (%.0f, %.0f, %.0f) mm: assigned to %.80s",
                  static_cast<long long>(island.voxels), island.voxels == 1 ? "voxel" : "voxels", island.tissue.c_str(),
                  island.centre.x, island.centre.y, island.centre.z, armature.bones[island.bone].name.c_str());
    report.warnings.push_back(text);
  }
  if (const size_t others = islands.size() - std::min(islands.size(), kMostLines); others > 0)
    report.warnings.push_back("no bone reaches " + std::to_string(others) + " smaller " +
                              (others == 1 ? "piece either; it is assigned to its nearest bone"
                                           : "pieces either; each is assigned to its nearest bone"));
}

}  // namespace limber
