// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/compare_wipe.h"

#include <algorithm>
#include <cmath>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/ui/ui.h"

namespace limber::editor {

float wipe_line(const Comparison& comparison, const Rect& rect) {
  return std::round(glm::mix(rect.low.x, rect.high.x, comparison.share));
}

bool over_side_a(const Context& context, const ViewPlace& place) {
  if (!context.views->other_scene) return false;
  return context.screen->layout.by_sides ? place.side_a
                                         : context.ui->input.pointer.x < wipe_line(context.comparison, place.rect);
}

const render::Scene& scene_of(const Context& context, const ViewPlace& place) {
  return place.side_a && context.views->other_scene ? *context.views->other_scene : context.views->scene;
}

const render::Scene& scene_at_pointer(const Context& context, const ViewPlace& place) {
  return over_side_a(context, place) ? *context.views->other_scene : context.views->scene;
}

const render::View3D& body_at_pointer(const Context& context, const ViewPlace& place) {
  const BodyView& body = context.views->body;
  if (over_side_a(context, place) && body.other) return *body.other;
  return body.shows_refined ? *body.refined : *body.picture;
}

namespace {

// Returns the voxel at rest for a point on the surface of a refined pose. The preview's surface may lie up to a few
// voxels deeper, so the first voxel with the label that was hit is taken, on the way inwards.
std::optional<glm::ivec3> voxel_at_rest(const render::Scene& preview, const render::Hit& hit,
                                        const glm::dvec3& inwards) {
  const Grid& grid = preview.volume->grid;
  const double step = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z}) / 4;
  std::optional<glm::ivec3> tissue;  // the first voxel with any tissue
  for (int i = 0; i < 16; ++i) {
    const auto voxel = voxel_shown_at(preview, hit.point + inwards * (i * step));
    const Label label = voxel ? preview.volume->at_or_air(*voxel) : Label{0};
    if (label == hit.label) return voxel;
    if (label != 0 && !tissue) tissue = voxel;
  }
  return tissue;
}

}  // namespace

std::optional<render::Hit> pick_body(const Context& context, const ViewPlace& place, const glm::ivec2& pixel) {
  const Views& views = *context.views;
  auto hit = body_at_pointer(context, place).pick(pixel);
  if (!hit || !views.body.shows_refined) return hit;
  const bool is_cut = hit->normal == glm::dvec3(0);
  const auto ray = render::ray_through(views.body.camera, glm::dvec2(pixel) + 0.5, glm::ivec2(place.rect.size()));
  const auto voxel = voxel_at_rest(views.scene, *hit, is_cut ? ray.direction : -hit->normal);
  if (!voxel) return std::nullopt;
  hit->voxel = *voxel;
  return hit;
}

}  // namespace limber::editor
