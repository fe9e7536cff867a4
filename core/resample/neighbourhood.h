// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests on the 26 voxels around a voxel: whether a tissue can lose or gain the voxel without a change of topology.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/volume/connected_components.h"
#include "core/volume/label_view.h"

namespace limber {

// Smallest connected component, in voxels, that counts when the components of a tissue are compared with those at rest.
// Smaller components appear and disappear by resampling alone.
constexpr std::int64_t kSmallestPart = 50;

// Returns the rest point that the pose moves to a given tissue voxel of the posed volume. Both are in voxel
// coordinates.
using RestPoint = std::function<glm::dvec3(const glm::ivec3& posed_voxel)>;

// Returns the offsets from a voxel to its 26 neighbours.
const std::array<glm::ivec3, 26>& neighbours();
// The offsets from a voxel to the six neighbours that share a face with it.
constexpr std::array<glm::ivec3, 6> kFaceNeighbours{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// Returns the voxel at an index of a grid, x fastest.
inline glm::ivec3 voxel_at(const Grid& grid, std::int64_t at) {
  return {int(at % grid.size.x), int(at / grid.size.x % grid.size.y), int(at / grid.size.x / grid.size.y)};
}

// Returns the index in components.runs of the voxel run (along x) that contains voxel v. If no run does, returns the
// index of the next run.
std::int64_t run_at(const Components& components, const LabelView& volume, const glm::ivec3& v);

// Returns the index of the connected component that a tissue voxel belongs to.
inline int component_at(const Components& components, const LabelView& volume, const glm::ivec3& v) {
  return components.runs[run_at(components, volume, v)].component;
}

// Returns the voxel with `label` that is nearest (in mm) to a point in voxel coordinates. Returns nothing if there is
// no such voxel within 8 voxels.
std::optional<glm::ivec3> nearest_voxel(const LabelView& volume, Label label, const glm::dvec3& point);

// Returns the connected component of `label` that is nearest to a point in voxel coordinates; -1: there is none within
// 8 voxels.
int nearest_component(const Components& components, const LabelView& volume, Label label, const glm::dvec3& point);

// Returns true if the marked neighbours of a voxel are 26-connected without the voxel itself, and at least one is
// marked.
//   marked  the 3^3 voxels around the voxel, x fastest; the entry of the voxel itself is ignored
bool is_connected_26(const std::array<bool, 27>& marked);

// Returns true if the voxel's tissue can lose the voxel without coming apart there: the neighbours that have the same
// label are 26-connected without the voxel.
bool is_simple_point(const LabelView& volume, const glm::ivec3& voxel);

// Returns true if the tissue `label` can gain the voxel without joining two of its components or closing a loop: at
// least one neighbour of the voxel has the label, and all neighbours with the label are 26-connected.
bool can_join(const LabelView& volume, const glm::ivec3& voxel, Label label);

// Returns true if a voxel can change from air to tissue or back without a change of the body's components, holes and
// cavities: it is a simple point, for 26-connected tissue and 6-connected air [Bertrand & Malandain, Pattern
// Recognition Letters 15, 1994].
bool air_can_change(const LabelView& volume, const glm::ivec3& voxel);

// Returns true if all 26 neighbours have the same label as the voxel.
bool is_enclosed(const LabelView& volume, const glm::ivec3& voxel);

// Returns true if the voxel's tissue can lose the voxel without coming apart, and if neither the voxel nor any of its
// 26 neighbours is air or outside the grid.
bool can_spare_inside(const LabelView& volume, const glm::ivec3& voxel);

// Returns a pseudo-random number for the voxel index `at`, always the same for the same index. Lists of equally good
// voxels are sorted by this number, so that their first entries do not all lie on one side of the body.
std::uint64_t shuffled(std::uint64_t at);

// Returns true if at least one of a voxel's six face neighbours is air or outside the grid.
bool touches_air(const LabelView& volume, const glm::ivec3& voxel);

}  // namespace limber
