// SPDX-License-Identifier: AGPL-3.0-or-later
// The 26 voxels around a voxel, and what tissues lose and gain when a voxel is given by one to another.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/volume/connected_components.h"

namespace limber {

constexpr std::int64_t kSmallestPart = 50;  // voxels; what is smaller comes and goes with the grid

// The rest point that a tissue voxel of the posed volume is the image of; both in voxel coordinates.
using RestPoint = std::function<glm::dvec3(const glm::ivec3& posed_voxel)>;

const std::array<glm::ivec3, 26>& neighbours();
// The six of them that share a face with it.
constexpr std::array<glm::ivec3, 6> kFaceNeighbours{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// The voxel at a place of a grid, x fastest.
inline glm::ivec3 voxel_at(const Grid& grid, std::int64_t at) {
  return {int(at % grid.size.x), int(at / grid.size.x % grid.size.y), int(at / grid.size.x / grid.size.y)};
}

// The place in components.runs of the run that holds a voxel, or else of the next one that ends after it.
std::int64_t run_at(const Components& components, const LabelVolume& volume, const glm::ivec3& v);

// The component of a tissue voxel.
inline int component_at(const Components& components, const LabelVolume& volume, const glm::ivec3& v) {
  return components.runs[run_at(components, volume, v)].component;
}

// The voxel of `label` nearest to a point in voxel coordinates, by mm; none when there is none within 8 voxels.
std::optional<glm::ivec3> nearest_voxel(const LabelVolume& volume, Label label, const glm::dvec3& point);

// The rest component of `label` nearest to a rest point, -1 when there is none within 8 voxels.
int nearest_component(const Components& components, const LabelVolume& volume, Label label, const glm::dvec3& point);

// Whether the marked ones of a voxel's surroundings hang together, 26-connected, without the voxel itself; not when
// none is.
//   marked  27, x fastest; the middle one counts for nothing
bool is_connected_26(const std::array<bool, 27>& marked);

// Whether its tissue can spare the voxel: what is left of it around hangs together.
bool is_simple_point(const LabelVolume& volume, const glm::ivec3& voxel);

// Whether a tissue may have the voxel without two of its parts, or two ends of one, being joined: the label's voxels
// around it hang together, and there is one.
bool can_join(const LabelVolume& volume, const glm::ivec3& voxel, Label label);

// Whether a voxel can go from air to tissue, or back, and the body's parts, holes and cavities stay as they are: it is
// a simple point, for tissue of 26 and air of 6 neighbours [Bertrand & Malandain, Pattern Recognition Letters 15,
// 1994].
bool air_can_change(const LabelVolume& volume, const glm::ivec3& voxel);

// Whether all 26 voxels around have the voxel's own label.
bool is_enclosed(const LabelVolume& volume, const glm::ivec3& voxel);

// The same, and neither the voxel nor one of the 26 around it is air or outside the grid.
bool can_spare_inside(const LabelVolume& volume, const glm::ivec3& voxel);

// A number for the place of a voxel, as if at random, the same each time: ordered by it, voxels that are equally good
// do not all lie on one side of a body.
std::uint64_t shuffled(std::uint64_t at);

// Whether one of the six voxels at its faces is air or outside the grid.
bool touches_air(const LabelVolume& volume, const glm::ivec3& voxel);

}  // namespace limber
