// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds points of the volume to which a dragged joint of the rig snaps: the middle of bone tissue, or the centre of a
// voxel. Points are world positions in mm.
#pragma once

#include <optional>

#include "core/project/document.h"

namespace limber::editor {

struct ViewProjection;

// Returns the middle of the bone tissue under a pixel; no value if there is none. In the 3D view, it is the middle of
// the first bone on the line of sight; in a slice view, the middle of the bone's cross-section.
std::optional<glm::dvec3> middle_of_bone(const Document& document, const ViewProjection& view, const glm::dvec2& pixel);
// Returns the middle of the bone tissue around a point, in the plane that the unit vectors `right` and `up` span.
// Returns no value if the point lies outside bone tissue.
std::optional<glm::dvec3> middle_of_bone(const Document& document, const glm::dvec3& point, const glm::dvec3& right,
                                         const glm::dvec3& up);

// Returns the centre of the voxel that is nearest to a point; no value without a volume.
std::optional<glm::dvec3> nearest_voxel(const Document& document, const glm::dvec3& point);

}  // namespace limber::editor
