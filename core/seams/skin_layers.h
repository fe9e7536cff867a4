// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how deep fat and muscle lie below skin at the air. On an arm of 3 mm voxels, for example, fat begins one or
// two voxels below the air, muscle two or three. Where two limbs touch, the surface of each should have the same
// layers. When muscle lies right below a cut, the cut is too deep on that side. Skin that lies on the fat of one limb
// and on the muscle of the other belongs to the first. So the skin at the air of a body tells to which limb the tissue
// between two limbs belongs.
//
// Depths are counted in voxels on rays along a voxel axis, which start at the air and enter the body through skin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// The layers of tissue below the air, from outside inwards. Sheet: skin and connective tissue. Fat: also unknown
// tissue. Muscle: also vessels, blood and nerves. Deep: all other kinds, such as bone and organs.
enum class Layer : std::uint8_t { Sheet, Fat, Muscle, Deep };
constexpr int kLayers = 4;

Layer layer_of(TissueKind kind);
// Returns the layer of each label, from the tissue kind of each label.
std::vector<Layer> layers_of(const std::vector<TissueKind>& kinds);

// A ray that enters the body through skin, with the depths at which it first meets fat, muscle and deeper tissue.
struct SkinRay {
  std::int64_t place;  // index of the skin voxel in the list of tissue voxels
  std::uint8_t axis;
  // For each layer, the depth at which the ray first meets this layer or a deeper one, in voxels below the skin face at
  // the air. If the ray meets no such layer, the depth is the ray's length.
  std::array<std::uint16_t, kLayers> first;
};

// Returns one ray for each skin face at the air of a body. Rays that reach air again or never leave the skin are left
// out.
//   kind  tissue kind of each label
std::vector<SkinRay> skin_rays(const LabelVolume& volume, const TissueVoxels& tissue,
                               const std::vector<TissueKind>& kind);

class SkinLayers {
 public:
  // Measures the layers on those rays for which is_of(place) returns true, where `place` is the index of the ray's skin
  // voxel in the list of tissue voxels.
  //   spacing  voxel size of the body, mm
  template <class IsOf>
  SkinLayers(const std::vector<SkinRay>& rays, const glm::dvec3& spacing, const IsOf& is_of) : SkinLayers(spacing) {
    for (const SkinRay& ray : rays)
      if (is_of(ray.place)) add(ray);
    finish();
  }

  // Returns how unusual it is, [0, 1], that `layer` or a deeper layer lies at most `steps` voxels below the air on a
  // ray along an axis. The result is 0 if at least half of the rays meet the layer within these steps, and 1 if at most
  // a twentieth of them do. It is 0 too if there are too few rays.
  double surprise(int axis, Layer layer, int steps) const {
    return steps < reach_[axis] ? surprise_[axis][static_cast<int>(layer)][steps] : 0;
  }
  // Returns the depth along an axis, in voxels, below which surprise() is 0 for every layer.
  int reach(int axis) const { return reach_[axis]; }

 private:
  explicit SkinLayers(const glm::dvec3& spacing);
  void add(const SkinRay& ray);
  void finish();

  std::array<int, 3> steps_{}, reach_{};
  std::array<std::int64_t, 3> rays_{};
  // Number of rays, by axis, layer and the depth at which they first meet the layer.
  std::array<std::array<std::vector<std::int64_t>, kLayers>, 3> met_;
  std::array<std::array<std::vector<double>, kLayers>, 3> surprise_;
};

}  // namespace limber
