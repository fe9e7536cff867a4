// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weight_at.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber {

namespace {

class Sampler {
 public:
  Sampler(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights)
      : volume_(volume),
        tissue_(tissue),
        weights_(weights) {}

  SkinAt at(const glm::dvec3& voxel) const {
    const glm::dvec3 low = glm::floor(voxel), share = voxel - low;
    std::vector<std::pair<int, double>> bones;
    double most = 0;
    Label label = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 bits(corner & 1, corner >> 1 & 1, corner >> 2), v = glm::ivec3(low) + bits;
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= bits[axis] ? share[axis] : 1 - share[axis];
      if (weight <= 0 || !volume_.grid.contains(v) || tissue_.index_of(v) < 0) continue;
      const Influence influence = of(v);
      for (int i = 0; i < 4; ++i)
        if (influence.weight[i]) add(bones, influence.bone[i], weight * influence.weight[i]);
      if (weight > most) most = weight, label = volume_.voxels[volume_.grid.index(v)];
    }
    if (!bones.empty()) return {quantize(bones), label};
    const glm::ivec3 nearest = nearest_tissue(voxel);
    return {of(nearest), volume_.voxels[volume_.grid.index(nearest)]};
  }

 private:
  static void add(std::vector<std::pair<int, double>>& bones, int bone, double weight) {
    const auto found = std::find_if(bones.begin(), bones.end(), [&](const auto& entry) { return entry.first == bone; });
    if (found != bones.end()) found->second += weight;
    else bones.emplace_back(bone, weight);
  }

  Influence of(const glm::ivec3& v) const {
    const int brick = tissue_.brick_at(v);
    return weights_.chunk(brick)[tissue_.index_of(v) - tissue_.bricks()[brick].first];
  }

  // Returns the tissue voxel nearest to a point. Searches larger and larger cubes around the point. After the first hit
  // the search continues up to about twice that cube's size: the hit may be in a corner of the cube, and a larger cube
  // may contain a nearer voxel.
  glm::ivec3 nearest_tissue(const glm::dvec3& voxel) const {
    const glm::ivec3 size = volume_.grid.size,
                     centre = glm::clamp(glm::ivec3(glm::round(voxel)), glm::ivec3(0), size - 1);
    const glm::dvec3 spacing = volume_.grid.spacing;
    glm::ivec3 best(-1);
    double squared = 1e300;
    int last = std::max({size.x, size.y, size.z});
    for (int reach = 0; reach <= last; ++reach) {
      const glm::ivec3 low = glm::max(centre - reach, glm::ivec3(0)), high = glm::min(centre + reach, size - 1);
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x) {
            const glm::ivec3 v(x, y, z), off = glm::abs(v - centre);
            if (std::max({off.x, off.y, off.z}) != reach || tissue_.index_of(v) < 0) continue;
            const glm::dvec3 d = (glm::dvec3(v) - voxel) * spacing;
            if (glm::dot(d, d) < squared) squared = glm::dot(d, d), best = v;
          }
      if (best.x >= 0 && last > 2 * reach + 1) last = 2 * reach + 1;
    }
    return best;
  }

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  const SkinWeights& weights_;
};

}  // namespace

std::vector<SkinAt> skin_at(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                            std::span<const glm::dvec3> points) {
  if (tissue.size() == 0)
    throw Error("the volume has no tissue", "weights at points", "use a volume with labels other than 0");
  if (weights.size() != tissue.size()) throw std::logic_error("the weights belong to another volume");
  const Sampler sampler(volume, tissue, weights);
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  std::vector<SkinAt> skin(points.size());
  parallel_for(std::ssize(points), 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) skin[i] = sampler.at(to_voxel * points[i]);
  });
  return skin;
}

}  // namespace limber
