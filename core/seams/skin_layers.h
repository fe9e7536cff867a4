// SPDX-License-Identifier: AGPL-3.0-or-later
// How deep fat and muscle lie below free skin: on an arm of 3 mm voxels fat begins one or two voxels below the air,
// muscle two or three. Where two limbs touch, the surface of each ought to look the same. Muscle right below a cut
// tells that the cut lies too deep on that side, and skin that lies on the fat of one limb and on the muscle of the
// other is the skin of the first. So every body says itself whose the tissue between two limbs is.
//
// Depths are counted in voxels along an axis, on rays that come from the air and go in through skin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Tissues by how deep they lie. Sheet: skin and connective tissue; Deep: bone, organs and all that is not flesh.
enum class Layer : std::uint8_t { Sheet, Fat, Muscle, Deep };
constexpr int kLayers = 4;

Layer layer_of(TissueKind kind);

// Where a ray that goes in through skin meets fat, muscle and what is deeper.
struct SkinRay {
  std::int64_t place;  // of the skin in the list of tissue voxels
  std::uint8_t axis;
  std::array<std::uint16_t, kLayers>
      first;  // voxels below the air's face; for a layer that is not met, the ray's length
};

// All rays through the skin of a body. One that comes out again or never leaves the skin says nothing and is left out.
//   kind  by label
std::vector<SkinRay> skin_rays(const LabelVolume& volume, const TissueVoxels& tissue,
                               const std::vector<TissueKind>& kind);

class SkinLayers {
 public:
  //   rays     of one body, whose voxels have this spacing, mm
  //   is_of    (place) -> whether the skin there counts
  template <class IsOf>
  SkinLayers(const std::vector<SkinRay>& rays, const glm::dvec3& spacing, const IsOf& is_of) : SkinLayers(spacing) {
    for (const SkinRay& ray : rays)
      if (is_of(ray.place)) add(ray);
    finish();
  }

  // How unusual it is that a layer or what lies deeper is met within `steps` voxels along an axis below the air's face:
  // 0 where half of the rays meet it there, 1 where a twentieth or fewer do. 0 where too few rays were counted to tell.
  double surprise(int axis, Layer layer, int steps) const {
    return steps < reach_[axis] ? surprise_[axis][static_cast<int>(layer)][steps] : 0;
  }
  // Voxels along an axis from which on nothing surprises.
  int reach(int axis) const { return reach_[axis]; }

 private:
  explicit SkinLayers(const glm::dvec3& spacing);
  void add(const SkinRay& ray);
  void finish();

  std::array<int, 3> steps_{}, reach_{};
  std::array<std::int64_t, 3> rays_{};
  std::array<std::array<std::vector<std::int64_t>, kLayers>, 3> met_;  // by axis, layer and depth
  std::array<std::array<std::vector<double>, kLayers>, 3> surprise_;
};

}  // namespace limber
