// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/skin_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr double kDeepest = 30;                  // length of a ray, mm; deeper tissue tells nothing about the surface
constexpr std::int64_t kFewestRays = 200;        // with fewer rays along an axis, surprise() is 0
constexpr double kUsual = 0.5, kUnusual = 0.05;  // shares of rays: surprise() is 0 at kUsual and 1 at kUnusual

}  // namespace

Layer layer_of(TissueKind kind) {
  switch (kind) {
    case TissueKind::Skin:
    case TissueKind::Connective: return Layer::Sheet;
    case TissueKind::Unknown:
    case TissueKind::Fat: return Layer::Fat;
    case TissueKind::Muscle:
    case TissueKind::Vessel:
    case TissueKind::Blood:
    case TissueKind::Nerve: return Layer::Muscle;
    default: return Layer::Deep;
  }
}

std::vector<Layer> layers_of(const std::vector<TissueKind>& kinds) {
  std::vector<Layer> layers(kinds.size());
  std::transform(kinds.begin(), kinds.end(), layers.begin(), layer_of);
  return layers;
}

namespace {

// Returns the length of rays along an axis, in voxels.
int steps_along(const glm::dvec3& spacing, int axis) {
  return std::clamp(static_cast<int>(kDeepest / spacing[axis]), 2, int{std::numeric_limits<std::uint16_t>::max()});
}

// Casts rays inward from skin.
class SkinCaster {
 public:
  SkinCaster(const LabelVolume& volume, const std::vector<TissueKind>& kind)
      : volume_(volume),
        layer_(layers_of(kind)) {}

  // Casts a ray from a voxel of skin. Returns the ray, or nothing when it meets air or never leaves the skin.
  //   inward  direction of the ray, 0 to 5: towards lower x, higher x, lower y, higher y, lower z, higher z
  std::optional<SkinRay> cast(const glm::ivec3& voxel, int inward) const {
    const int axis = inward >> 1, step = inward & 1 ? 1 : -1, steps = steps_along(volume_.grid.spacing, axis);
    const glm::ivec3& size = volume_.grid.size;
    const int last = inward & 1 ? size[axis] - 1 : 0;
    // Stops if the ray would leave the grid, beyond which there is air.
    if (step * (last - voxel[axis]) + 1 < steps) return std::nullopt;
    const std::int64_t stride = step * (axis == 0 ? 1 : axis == 1 ? size.x : std::int64_t{size.x} * size.y);
    std::int64_t at = volume_.grid.index(voxel);
    SkinRay ray{0, static_cast<std::uint8_t>(axis), {}};
    ray.first.fill(static_cast<std::uint16_t>(steps));
    int met = 0;
    for (int k = 0; k < steps; ++k, at += stride) {
      const Label label = volume_.voxels[at];
      if (label == 0) return std::nullopt;
      for (const int layer = static_cast<int>(layer_[label]); met < layer;)
        ray.first[++met] = static_cast<std::uint16_t>(k);
    }
    return met > 0 ? std::optional(ray) : std::nullopt;
  }

 private:
  const LabelVolume& volume_;
  const std::vector<Layer> layer_;
};

}  // namespace

std::vector<SkinRay> skin_rays(const LabelVolume& volume, const TissueVoxels& tissue,
                               const std::vector<TissueKind>& kind) {
  constexpr std::int64_t kGrain = 64;  // bricks per block of a parallel loop
  const SkinCaster caster(volume, kind);
  LabelSet skin(kind.size());
  std::transform(kind.begin(), kind.end(), skin.begin(), [](TissueKind k) { return k == TissueKind::Skin; });
  const auto bricks = std::ssize(tissue.bricks());
  std::vector<std::vector<SkinRay>> found((bricks + kGrain - 1) / kGrain);
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    const auto cast_from = [&](std::int64_t place, const glm::ivec3& v) {
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        if (!volume.grid.contains(w) || volume.at(w) != 0) continue;
        if (auto ray = caster.cast(v, direction ^ 1)) {
          ray->place = place;
          found[begin / kGrain].push_back(*ray);
        }
      }
    };
    for (auto brick = begin; brick < end; ++brick) tissue.for_each_of(brick, volume, skin, cast_from);
  });
  std::vector<SkinRay> rays;
  for (const std::vector<SkinRay>& some : found) rays.insert(rays.end(), some.begin(), some.end());
  return rays;
}

SkinLayers::SkinLayers(const glm::dvec3& spacing) {
  for (int axis = 0; axis < 3; ++axis) {
    steps_[axis] = steps_along(spacing, axis);
    for (auto& met : met_[axis]) met.assign(steps_[axis], 0);
  }
}

void SkinLayers::add(const SkinRay& ray) {
  ++rays_[ray.axis];
  for (int l = 1; l < kLayers; ++l)
    if (ray.first[l] < steps_[ray.axis]) ++met_[ray.axis][l][ray.first[l]];
}

void SkinLayers::finish() {
  for (int axis = 0; axis < 3; ++axis)
    for (int l = 0; l < kLayers; ++l) {
      std::vector<double>& surprise = surprise_[axis][l];
      surprise.assign(steps_[axis], 0);
      if (l == 0 || rays_[axis] < kFewestRays) continue;
      std::int64_t met = 0;
      for (int k = 0; k < steps_[axis]; ++k) {
        met += met_[axis][l][k];
        const double share = static_cast<double>(met) / static_cast<double>(rays_[axis]);
        surprise[k] = std::clamp(std::log(std::max(share, 1e-9) / kUsual) / std::log(kUnusual / kUsual), 0.0, 1.0);
        if (surprise[k] > 0) reach_[axis] = std::max(reach_[axis], k + 1);
      }
    }
}

}  // namespace limber
