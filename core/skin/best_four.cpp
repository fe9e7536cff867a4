// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/best_four.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/base/parallel.h"

namespace limber {

namespace {
// Below this a weight is noise of the solve, in 1/65535.
constexpr int kLeastWeight = 7;

// Scales the sum to exactly kFullWeight; what rounding down leaves goes to the largest.
Influence normalized(Influence influence) {
  std::int64_t sum = 0;
  for (int k = 0; k < 4; ++k) sum += influence.weight[k];
  int left = kFullWeight;
  for (int k = 3; k > 0; --k) {
    const auto whole = static_cast<int>(influence.weight[k] * std::int64_t{kFullWeight} / sum);
    influence.weight[k] = static_cast<std::uint16_t>(whole);
    if (whole == 0) influence.bone[k] = 0;
    left -= whole;
  }
  influence.weight[0] = static_cast<std::uint16_t>(left);
  return influence;
}
}  // namespace

void BestFour::offer(const std::vector<std::int64_t>& place, const std::vector<float>& values, int lanes, int lane, int bone) {
  parallel_for(std::ssize(place), 16384, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const float value = values[i * lanes + lane];
      const int whole = static_cast<int>(std::lround(std::clamp(value, 0.0f, 1.0f) * kFullWeight));
      Influence& best = best_[place[i]];
      // Of equal weights the lower bone goes first, so that the order of offers does not show.
      auto after = [&](int k) { return whole > best.weight[k] || (whole == best.weight[k] && bone < best.bone[k]); };
      if (whole < kLeastWeight || !after(3)) continue;
      int k = 3;
      for (; k > 0 && after(k - 1); --k) {
        best.bone[k] = best.bone[k - 1];
        best.weight[k] = best.weight[k - 1];
      }
      best.bone[k] = static_cast<std::uint16_t>(bone);
      best.weight[k] = static_cast<std::uint16_t>(whole);
    }
  });
}

SkinWeights BestFour::weights(std::vector<std::string> bone_names, const TissueVoxels& tissue) const {
  SkinWeights weights(std::move(bone_names), tissue);
  for (std::int64_t b = 0; b < std::ssize(tissue.bricks()); ++b) {
    const auto& brick = tissue.bricks()[b];
    SkinWeights::Influences chunk(best_.begin() + brick.first, best_.begin() + brick.first + brick.count());
    for (Influence& influence : chunk) influence = normalized(influence);
    weights.set_chunk(b, std::move(chunk));
  }
  return weights;
}

std::vector<std::string> names_of_bones(const Armature& armature) {
  std::vector<std::string> names;
  for (const Bone& bone : armature.bones) names.push_back(bone.name);
  return names;
}

void cover_islands(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature, BestFour& best,
                   WeightsReport& report, const TissueTable* tissues) {
  struct Island {
    std::int64_t voxels;
    double file_value;  // of its first voxel's label
    glm::dvec3 centre;
    int bone;
  };
  std::vector<Island> islands;
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  std::vector<std::pair<std::int64_t, glm::ivec3>> piece;
  tissue.for_each([&](std::int64_t seed, const glm::ivec3& seed_voxel) {
    if (best.covered(seed)) return;
    // Covered for the time being, so that each is met once.
    piece.assign(1, {seed, seed_voxel});
    best.hold(seed, 0);
    glm::dvec3 sum(0);
    for (size_t k = 0; k < piece.size(); ++k) {
      const glm::ivec3 v = piece[k].second;
      sum += glm::dvec3(v);
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        if (volume.at_or_air(w) == 0) continue;
        const std::int64_t place = tissue.index_of(w);
        if (best.covered(place)) continue;
        best.hold(place, 0);
        piece.push_back({place, w});
      }
    }
    const Tissue* label = tissues ? tissues->find(volume.at(seed_voxel)) : nullptr;
    Island island{std::ssize(piece), label ? label->file_value : double(volume.at(seed_voxel)), from_voxel * (sum / double(piece.size())), 0};
    double nearest = std::numeric_limits<double>::max();
    for (size_t b = 0; b < armature.bones.size(); ++b)
      if (const double d = distance_to_bone(armature.bones[b], island.centre); d < nearest) nearest = d, island.bone = static_cast<int>(b);
    for (const auto& [place, voxel] : piece) best.hold(place, island.bone);
    islands.push_back(island);
  });

  std::stable_sort(islands.begin(), islands.end(), [](const Island& a, const Island& b) { return a.voxels > b.voxels; });
  constexpr size_t kMostLines = 5;
  for (size_t k = 0; k < std::min(islands.size(), kMostLines); ++k) {
    const Island& island = islands[k];
    char text[256];
    std::snprintf(text, sizeof text, "no bone reaches %lld voxels of label %.15g near (%.0f, %.0f, %.0f): given to %.80s",
                  static_cast<long long>(island.voxels), island.file_value, island.centre.x, island.centre.y, island.centre.z,
                  armature.bones[island.bone].name.c_str());
    report.warnings.push_back(text);
  }
  if (islands.size() > kMostLines)
    report.warnings.push_back("no bone reaches " + std::to_string(islands.size() - kMostLines) +
                              " smaller pieces either: each given to the bone nearest to it");
}

}  // namespace limber
