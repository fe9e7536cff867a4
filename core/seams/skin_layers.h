// SPDX-License-Identifier: AGPL-3.0-or-later
// How deep fat and muscle lie below free skin: on an arm of 3 mm voxels fat begins one or two voxels below the air, muscle
// two or three. Where two limbs touch, the surface of each ought to look the same. Muscle right below a cut tells that the
// cut lies too deep on that side, and skin that lies on the fat of one limb and on the muscle of the other is the skin of the
// first. So every body says itself whose the tissue between two limbs is.
//
// Depths are counted in voxels along an axis, on rays that come from the air and go in through skin.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"
#include "core/volume/tissue_table.h"

namespace limber {

// Tissues by how deep they lie. Sheet: skin and connective tissue; Deep: bone, organs and all that is not flesh.
enum class Layer : std::uint8_t { Sheet, Fat, Muscle, Deep };
constexpr int kLayers = 4;

Layer layer_of(TissueKind kind);

class SkinLayers {
 public:
  //   spacing  of voxels, mm
  explicit SkinLayers(const glm::dvec3& spacing);

  // Counts the ray that goes in through the skin of a voxel; one that comes out again or never leaves the skin says nothing.
  //   inward    direction of the ray: 0 towards lower x, 1 towards higher x, 2 and 3 along y, 4 and 5 along z
  //   layer_at  (voxel) -> std::optional<Layer>, none in air; voxels may lie outside the grid
  template <class LayerAt>
  void add_ray(glm::ivec3 voxel, int inward, const LayerAt& layer_at) {
    const int axis = inward >> 1, step = inward & 1 ? 1 : -1;
    std::array<int, kLayers> first;
    first.fill(steps_[axis]);
    for (int k = 0; k < steps_[axis]; ++k, voxel[axis] += step) {
      const auto layer = layer_at(voxel);
      if (!layer) return;
      for (int l = 1; l <= static_cast<int>(*layer); ++l) first[l] = std::min(first[l], k);
    }
    if (first[1] == steps_[axis]) return;
    ++rays_[axis];
    for (int l = 1; l < kLayers; ++l)
      for (int k = first[l]; k < steps_[axis]; ++k) ++count_[axis][l][k];
  }
  // Call once all rays are counted.
  void finish();

  // How unusual it is that a layer or what lies deeper is met within `steps` voxels along an axis below the air's face: 0
  // where half of the rays meet it there, 1 where a twentieth or fewer do. 0 where too few rays were counted to tell.
  double surprise(int axis, Layer layer, int steps) const {
    return steps < reach_[axis] ? surprise_[axis][static_cast<int>(layer)][steps] : 0;
  }
  // Voxels along an axis from which on nothing surprises.
  int reach(int axis) const { return reach_[axis]; }

 private:
  std::array<int, 3> steps_{}, reach_{};
  std::array<std::int64_t, 3> rays_{};
  std::array<std::array<std::vector<std::int64_t>, kLayers>, 3> count_;  // by axis, layer and depth
  std::array<std::array<std::vector<double>, kLayers>, 3> surprise_;
};

}  // namespace limber
