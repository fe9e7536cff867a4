// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/brush_settings.h"

#include <algorithm>

#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/painted_region.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"

namespace limber::editor {

Normalize normalize_of(const Context& context) {
  const Painting& painting = *context.skin->painting;
  return painting.normalize == Normalize::WhenComposed && (!active_layer(context) || painting.mask)
             ? Normalize::Unlocked
             : painting.normalize;
}

std::optional<BrushPlace> brush_place(Context& context, const ViewPlace& view, const glm::vec2& pixel) {
  const render::Scene& scene = context.views->scene;
  if (!scene.volume || !is_of_document(context, scene.volume)) return std::nullopt;
  const AffineTransform to_world = world_from_voxel(scene.volume->grid);
  if (view.id == ViewId::Body) {
    const auto hit = context.views->body.picture->pick(glm::ivec2(pixel - view.rect.low));
    if (!hit) return std::nullopt;
    const glm::dvec3 normal = glm::dot(hit->normal, hit->normal) > 0
                                  ? hit->normal
                                  : ViewProjection(context, view).direction_to_eye(hit->point);
    return BrushPlace{view.id, hit->point, normal, scene.pose ? to_world * glm::dvec3(hit->voxel) : hit->point};
  }
  const ViewProjection seen(context, view);
  const glm::dvec3 point = world_of(slice_of(*context.views, view.id).camera, pixel - view.rect.low, view.rect.size());
  const auto voxel = voxel_shown_at(scene, point);
  if (!voxel || scene.volume->at_or_air(*voxel) == 0) return std::nullopt;
  return BrushPlace{view.id, point, seen.towards_eye, scene.pose ? to_world * glm::dvec3(*voxel) : point};
}

std::string why_not_paint(const Context& context) {
  const Document& document = context.document();
  if (!document.volume) return "Open a volume first";
  if (!document.armature) return "Import or auto-fit a rig first";
  if (!document.weights) return "There are no weights yet: compute weights first";
  const auto bone = skin_bone(context);
  if (!bone || weights_bone(*document.weights, document.armature->bones[*bone].name) < 0)
    return "The weights belong to another rig: compute them again";
  return why_not_paint_layer(context);
}

std::string why_brush_reaches_nothing(const Context& context) {
  if (context.skin->painting->tissue == PaintedTissue::Chosen && context.selection->tissues.empty())
    return "No tissue is selected: select one in the list, or paint all tissue";
  return "";
}

namespace {

// Returns the set of the bone, its parent and all its descendants. The set has one entry for each bone of `weights`,
// in the order of the weights.
BoneSet bones_about(const Armature& armature, int bone, const SkinWeights& weights) {
  BoneSet set(weights.bones().size(), 0);
  for (int b = 0; b < std::ssize(armature.bones); ++b) {
    int above = b;
    while (above >= 0 && above != bone) above = armature.bones[above].parent;
    if (above < 0 && b != armature.bones[bone].parent) continue;
    if (const int place = weights_bone(weights, armature.bones[b].name); place >= 0) set[place] = 1;
  }
  return set;
}

}  // namespace

StrokeSettings stroke_settings(const Context& context, BrushKind kind) {
  const Painting& painting = *context.skin->painting;
  const Document& document = context.document();
  StrokeSettings settings;
  Brush& brush = settings.brush;
  brush.kind = kind;
  brush.radius = painting.radius;
  brush.strength = painting.strength;
  brush.value = painting.value;
  brush.falloff = falloff_of(painting);
  brush.spacing = painting.spacing;
  brush.accumulate = painting.accumulate;
  brush.distance = painting.distance;
  brush.blend_mm = painting.blend_mm;
  brush.reference = context.views->cross_hair;

  const SkinWeights& weights = *document.weights;
  const auto add = [&](int bone) {
    const int index = weights_bone(weights, document.armature->bones[bone].name);
    if (index >= 0 && std::find(settings.bones.begin(), settings.bones.end(), index) == settings.bones.end())
      settings.bones.push_back(index);
  };
  add(*skin_bone(context));
  if (!rule_of(kind).one_bone)
    for (const int bone : context.selection->bones) add(bone);
  settings.locked.assign(weights.bones().size(), 0);
  for (std::size_t bone = 0; bone < settings.locked.size(); ++bone)
    settings.locked[bone] = is_locked(document, weights.bones()[bone]);
  settings.normalize = normalize_of(context);
  settings.relative_to_locks = painting.relative_to_locks;

  BrushFilter& filter = settings.filter;
  filter.depth = painting.depth;
  filter.depth_mm = painting.depth_mm;
  if (painting.tissue != PaintedTissue::All) {
    filter.labels.assign(65536, 0);
    for (const Tissue& tissue : document.tissues->tissues) {
      const bool visible = !context.views->scene.looks || (*context.views->scene.looks)[tissue.label].visible;
      const bool allowed = painting.tissue == PaintedTissue::Visible ? visible
                           : painting.tissue == PaintedTissue::Chosen
                               ? context.selection->tissues.contains(tissue.label)
                               : visible && !is_bone(tissue.kind);
      filter.labels[tissue.label] = allowed;
    }
  }
  if (const Visibility* visibility = document.visibility.get()) {
    if (visibility->clip_box.enabled)
      filter.box = BrushFilter::Box{visibility->clip_box.low, visibility->clip_box.high};
    if (visibility->clip_plane.enabled)
      filter.plane = BrushFilter::Plane{visibility->clip_plane.point, visibility->clip_plane.normal};
  }
  const auto region = painted_region(context);
  if (painting.subtree && context.views->tissue_voxels) {
    filter.allows = [region, weights = document.weights, tissue = context.views->tissue_voxels,
                     own = bones_about(*document.armature, *skin_bone(context), *document.weights)](
                        std::int64_t place, const glm::ivec3& voxel) {
      if (region && (*region)[static_cast<std::size_t>(place)] == 0) return false;
      const int brick = tissue->brick_at(voxel);
      return own[weights
                     ->chunk(brick)[static_cast<std::size_t>(place -
                                                             tissue->bricks()[static_cast<std::size_t>(brick)].first)]
                     .bone[0]] != 0;
    };
  } else if (region)
    filter.allows = [region](std::int64_t place, const glm::ivec3&) {
      return (*region)[static_cast<std::size_t>(place)] != 0;
    };
  if (context.transform_settings->x_mirror) settings.mirror = mirror_plane(*document.armature);
  return settings;
}

}  // namespace limber::editor
