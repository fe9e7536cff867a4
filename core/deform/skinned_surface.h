// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of what is shown of a body, as triangles that know what they follow, for outlines of other poses. The
// surface lies where the renderer's rays meet the body (the set of labels, blurred twice by [1 2 1] / 4 along each
// axis, at the share that keeps a silhouette its size), as surface nets (core/mesh/surface.h); a pose carries its
// vertices by the blend kernel. The same for any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SkinnedSurface {
  std::vector<glm::dvec3> V;    // #V places at rest, world, mm
  std::vector<glm::u32vec3> F;  // #F corners, counter-clockwise seen from outside
  std::vector<Label> label;     // #V, of the shown tissue just inside
  std::vector<std::int64_t>
      offsets;  // #V + 1: vertex i follows influences[offsets[i]] up to influences[offsets[i + 1]]
  std::vector<BoneWeight> influences;  // of the weights' bones
};

// The surface in a pose.
struct PosedSurface {
  std::shared_ptr<const SkinnedSurface> at_rest;
  std::vector<glm::vec3> V, N;  // #V places, world, mm; unit, out of the body
};

//   shown     the labels that are seen; without any tissue among them the surface is empty
//   vertices  at most about so many: cells are made coarser until they are no more
// Throws Error when the volume has no tissue; std::logic_error when the weights are another volume's.
SkinnedSurface skinned_surface(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                               const LabelSet& shown, std::int64_t vertices);

//   posed_from_rest  #bones of the weights
PosedSurface posed_surface(const std::shared_ptr<const SkinnedSurface>& at_rest,
                           const std::vector<RigidTransform>& posed_from_rest, Blend blend);

}  // namespace limber
