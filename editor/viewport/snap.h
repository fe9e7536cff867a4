// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a joint snaps to in the volume. Points of the world, mm.
#pragma once

#include <optional>

#include "core/project/document.h"
#include "editor/context/view_projection.h"

namespace limber::editor {

// The middle of the bone tissue under a pixel: along the line of sight in the 3D view, in its plane in a slice. Nothing
// where there is none.
std::optional<glm::dvec3> middle_of_bone(const Document& document, const ViewProjection& view, const glm::dvec2& pixel);
// The middle of the bone tissue that a point lies in, in the plane of two directions (unit).
std::optional<glm::dvec3> middle_of_bone(const Document& document, const glm::dvec3& point, const glm::dvec3& right,
                                         const glm::dvec3& up);

// The centre of the voxel nearest to a point, inside the volume; nothing without one.
std::optional<glm::dvec3> nearest_voxel(const Document& document, const glm::dvec3& point);

}  // namespace limber::editor
