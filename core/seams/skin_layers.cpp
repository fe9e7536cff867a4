// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/skin_layers.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {

constexpr double kDeepest = 30;                  // mm: what lies deeper says nothing of the surface
constexpr std::int64_t kFewestRays = 200;        // along an axis
constexpr double kUsual = 0.5, kUnusual = 0.05;  // of the rays

}  // namespace

Layer layer_of(TissueKind kind) {
  switch (kind) {
    case TissueKind::Skin: case TissueKind::Connective: return Layer::Sheet;
    case TissueKind::Unknown: case TissueKind::Fat: return Layer::Fat;
    case TissueKind::Muscle: case TissueKind::Vessel: case TissueKind::Blood: case TissueKind::Nerve: return Layer::Muscle;
    default: return Layer::Deep;
  }
}

SkinLayers::SkinLayers(const glm::dvec3& spacing) {
  for (int axis = 0; axis < 3; ++axis) {
    steps_[axis] = std::max(2, static_cast<int>(kDeepest / spacing[axis]));
    for (auto& count : count_[axis]) count.assign(steps_[axis], 0);
  }
}

void SkinLayers::finish() {
  for (int axis = 0; axis < 3; ++axis)
    for (int l = 0; l < kLayers; ++l) {
      std::vector<double>& surprise = surprise_[axis][l];
      surprise.assign(steps_[axis], 0);
      if (l == 0 || rays_[axis] < kFewestRays) continue;
      for (int k = 0; k < steps_[axis]; ++k) {
        const double share = static_cast<double>(count_[axis][l][k]) / static_cast<double>(rays_[axis]);
        surprise[k] = std::clamp(std::log(std::max(share, 1e-9) / kUsual) / std::log(kUnusual / kUsual), 0.0, 1.0);
        if (surprise[k] > 0) reach_[axis] = std::max(reach_[axis], k + 1);
      }
    }
}

}  // namespace limber
