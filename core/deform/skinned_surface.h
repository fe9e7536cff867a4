// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the surface of the visible part of a body as triangles with bone weights. It is used to draw the outlines of
// other poses. Surface nets (core/mesh/surface.h) put the surface where the renderer's rays meet the body: the share of
// visible labels is blurred twice by [1 2 1] / 4 along each axis, and the surface is where the blurred share has the
// value that makes the silhouette as large as the body's. A pose moves the vertices by the blend kernel (skinning.h).
// The result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SkinnedSurface {
  std::vector<glm::dvec3> V;           // #V positions at rest, world, mm
  std::vector<glm::u32vec3> F;         // #F triangles, counter-clockwise seen from outside
  std::vector<Label> label;            // #V: label of the visible tissue just inside
  std::vector<std::int64_t> offsets;   // #V + 1: index of the first influence of each vertex
  std::vector<BoneWeight> influences;  // influences of all vertices; bone indices are those of SkinWeights
};

// The surface in one pose.
struct PosedSurface {
  std::shared_ptr<const SkinnedSurface> at_rest;
  std::vector<glm::vec3> V, N;  // #V posed positions, world, mm; unit normals, pointing out of the body
};

// Builds the surface at rest.
//   shown     the visible labels; the surface is empty if they contain no tissue
//   vertices  upper limit on the number of vertices; cells are made coarser until it is met
//   throws Error if the volume has no tissue; std::logic_error if the weights belong to another volume
SkinnedSurface skinned_surface(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                               const LabelSet& shown, std::int64_t vertices);

// Poses the surface.
//   posed_from_rest  motions of the bones of the weights
PosedSurface posed_surface(const std::shared_ptr<const SkinnedSurface>& at_rest,
                           const std::vector<RigidTransform>& posed_from_rest, Blend blend);

}  // namespace limber
