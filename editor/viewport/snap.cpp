// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/snap.h"

#include <algorithm>

#include "editor/context/view_projection.h"

namespace limber::editor {

namespace {

// Number of iterations of the search for the middle of a bone's cross-section. Each iteration moves the point to the
// middle along `right`, then along `up`. Two iterations suffice for a round cross-section.
constexpr int kRounds = 4;

// Samples the bone tissue of the document's volume along lines, in steps of half a voxel.
class BoneTissue {
 public:
  explicit BoneTissue(const Document& document)
      : document_(document),
        grid_(document.volume->grid),
        voxel_(voxel_from_world(grid_)),
        step_(std::min({grid_.spacing.x, grid_.spacing.y, grid_.spacing.z}) / 2),
        reach_(glm::length(grid_.spacing * glm::dvec3(grid_.size))) {}

  double step() const { return step_; }
  double reach() const { return reach_; }

  bool at(const glm::dvec3& point) const {
    const Label label = document_.volume->at_or_air(glm::ivec3(glm::round(glm::clamp(voxel_ * point, -1.0, 1e6))));
    const Tissue* tissue = label && document_.tissues ? document_.tissues->find(label) : nullptr;
    return tissue && is_bone(tissue->kind);
  }

  // Follows a line from a point in bone tissue in both directions up to the end of the bone tissue. Returns the middle
  // between both ends.
  glm::dvec3 middle_of_run(const glm::dvec3& point, const glm::dvec3& direction) const {
    double low = 0, high = 0;
    while (low > -reach_ && at(point + direction * (low - step_))) low -= step_;
    while (high < reach_ && at(point + direction * (high + step_))) high += step_;
    return point + direction * ((low + high) / 2);
  }

 private:
  const Document& document_;
  const Grid& grid_;
  AffineTransform voxel_;
  double step_, reach_;
};

}  // namespace

std::optional<glm::dvec3> middle_of_bone(const Document& document, const glm::dvec3& point, const glm::dvec3& right,
                                         const glm::dvec3& up) {
  if (!document.volume) return std::nullopt;
  const BoneTissue bone(document);
  if (!bone.at(point)) return std::nullopt;
  glm::dvec3 middle = point;
  for (int i = 0; i < kRounds; ++i) middle = bone.middle_of_run(bone.middle_of_run(middle, right), up);
  return middle;
}

std::optional<glm::dvec3> middle_of_bone(const Document& document, const ViewProjection& view,
                                         const glm::dvec2& pixel) {
  if (!document.volume) return std::nullopt;
  const render::Ray sight = view.ray(pixel);
  if (view.place.id != ViewId::Body) return middle_of_bone(document, sight.origin, view.right, view.up);
  const BoneTissue bone(document);
  const Grid& grid = document.volume->grid;
  const glm::dvec3 middle = world_from_voxel(grid) * ((glm::dvec3(grid.size) - 1.0) * 0.5);
  const double depth = glm::dot(middle - sight.origin, sight.direction);
  for (double t = std::max(0.0, depth - bone.reach()); t < depth + bone.reach(); t += bone.step())
    if (bone.at(sight.origin + t * sight.direction)) {
      // First finds the bone's middle along the line of sight, then the middle across it. So the pointer need not point
      // at the middle of the bone.
      glm::dvec3 point = bone.middle_of_run(sight.origin + t * sight.direction, sight.direction);
      if (!bone.at(point)) return point;
      for (int i = 0; i < 2; ++i) point = bone.middle_of_run(bone.middle_of_run(point, view.right), view.up);
      return bone.at(point) ? bone.middle_of_run(point, sight.direction) : point;
    }
  return std::nullopt;
}

std::optional<glm::dvec3> nearest_voxel(const Document& document, const glm::dvec3& point) {
  if (!document.volume) return std::nullopt;
  const Grid& grid = document.volume->grid;
  return world_from_voxel(grid) *
         glm::round(glm::clamp(voxel_from_world(grid) * point, glm::dvec3(0), glm::dvec3(grid.size - 1)));
}

}  // namespace limber::editor
