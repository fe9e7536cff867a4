// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of a body as few triangles that follow its bones: for outlines and for what must be quick rather than exact.
#pragma once

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/mesh/surface.h"
#include "core/skin/skin_weights.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SkinnedSurface {
  TriangleMesh mesh;                  // at rest
  std::vector<Influence> influences;  // #V
};

//   step  mm between points, about
// Empty for a volume without tissue; std::logic_error when the weights are another volume's.
SkinnedSurface skinned_surface(const LabelVolume& volume, const SkinWeights& weights, double step);

// By linear blending.
//   motions  from rest to posed, of the weights' bones       returns  #V, mm
std::vector<glm::vec3> posed_points(const SkinnedSurface& surface, const std::vector<RigidTransform>& motions);

}  // namespace limber
