// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/painting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rig/mirror.h"
#include "editor/brush_ring.h"
#include "editor/dispatch.h"
#include "editor/editor.h"
#include "editor/gizmo_painter.h"
#include "editor/handling.h"
#include "editor/layers.h"
#include "editor/project.h"
#include "editor/seam_view.h"
#include "editor/skin_display.h"

namespace limber::editor {

namespace {

constexpr int kRingPoints = 64;
constexpr double kStepOfRadius = 0.5;  // of the radius as it is seen, that the pointer is followed by
constexpr int kMostSteps = 24;         // of one movement

// The same place on the other side; where the stroke dabs too.
glm::dvec3 mirrored(const Armature& armature, const glm::dvec3& point) { return mirror_plane(armature).place(point); }

// The vertical extent of a ring on the screen stays readable when it is seen from its edge.
Ring ring_at(const BrushPlace& place, const glm::dvec3& centre, double radius) {
  const glm::dvec3 axis = glm::normalize(place.normal), other = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  return {centre, axis, glm::normalize(glm::cross(axis, other)), radius};
}

}  // namespace

struct Painting::Running {
  // What the stroke refers to.
  Document document;
  std::shared_ptr<const TissueVoxels> tissue;
  LayerToEdit edited;
  // Of the layer: its canvas, or what stands for its mask or for what its bones share with what lies below, and the bones of that.
  enum class Of { Canvas, Mask, Shares } of = Of::Canvas;
  std::shared_ptr<const SkinWeights> before;
  Armature bones;
  std::optional<SkinWeights> shown;  // what comes out of the layers as the stroke goes on
  std::unique_ptr<Stroke> stroke;
  ViewPlace view;
  std::string label;
  glm::vec2 pixel{0};  // where the pointer was
};

Painting::Painting() = default;
Painting::~Painting() = default;

const char* name_of(BrushKind kind) {
  constexpr const char* kNames[] = {"Add", "Subtract", "Set", "Multiply", "Smooth", "Sharpen", "Average", "Smear", "Joint capsule"};
  return kNames[static_cast<int>(kind)];
}

Normalize normalize_of(const Editor& editor) {
  const Painting& painting = *editor.skin->painting;
  return painting.normalize == Normalize::WhenComposed && (!active_layer(editor) || painting.mask) ? Normalize::Unlocked : painting.normalize;
}

Falloff falloff_of(const Painting& painting) {
  return painting.falloff_curve.empty() ? Falloff(painting.falloff) : Falloff(std::span<const glm::dvec2>(painting.falloff_curve));
}

void begin_falloff_curve(Painting& painting) {
  constexpr int kParts = 4;
  const Falloff shape = falloff_of(painting);
  painting.falloff_curve.clear();
  for (int i = 0; i <= kParts; ++i) painting.falloff_curve.emplace_back(double(i) / kParts, shape(float(i) / kParts));
}

std::optional<BrushPlace> brush_place(Editor& editor, const ViewPlace& view, const glm::vec2& pixel) {
  const render::Scene& scene = editor.views->scene;
  if (!scene.volume || !is_of_document(editor, scene.volume)) return std::nullopt;
  const AffineTransform to_world = world_from_voxel(scene.volume->grid);
  if (view.id == ViewId::Body) {
    const auto hit = editor.views->body.picture->pick(glm::ivec2(pixel - view.rect.low));
    if (!hit) return std::nullopt;
    const glm::dvec3 normal = glm::dot(hit->normal, hit->normal) > 0 ? hit->normal : SeenFrom(editor, view).direction_to_eye(hit->point);
    return BrushPlace{view.id, hit->point, normal, scene.pose ? to_world * glm::dvec3(hit->voxel) : hit->point};
  }
  const SeenFrom seen(editor, view);
  const glm::dvec3 point = world_of(slice_of(*editor.views, view.id).camera, pixel - view.rect.low, view.rect.size());
  const auto voxel = voxel_shown_at(scene, point);
  if (!voxel || scene.volume->at_or_air(*voxel) == 0) return std::nullopt;
  return BrushPlace{view.id, point, seen.towards_eye, scene.pose ? to_world * glm::dvec3(*voxel) : point};
}

std::string why_not_paint(const Editor& editor) {
  const Document& document = editor.document();
  if (!document.volume || !document.armature) return "Open a volume with a rig first";
  if (!document.weights) return "There are no weights yet: compute them first";
  const auto bone = skin_bone(editor);
  if (!bone || weights_bone(*document.weights, document.armature->bones[*bone].name) < 0) return "The weights belong to another rig";
  return why_not_paint_layer(editor);
}

std::string why_brush_reaches_nothing(const Editor& editor) {
  if (editor.skin->painting->tissue == PaintedTissue::Chosen && editor.selection.tissues.empty()) return "No tissue is chosen: choose one in the list, or paint all tissue";
  return "";
}

namespace {

// The bone, the one that it hangs on, and all below it; of the weights' bones.
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

StrokeSettings stroke_settings(const Editor& editor, BrushKind kind) {
  const Painting& painting = *editor.skin->painting;
  const Document& document = editor.document();
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

  const SkinWeights& weights = *document.weights;
  const auto add = [&](int bone) {
    const int index = weights_bone(weights, document.armature->bones[bone].name);
    if (index >= 0 && std::find(settings.bones.begin(), settings.bones.end(), index) == settings.bones.end()) settings.bones.push_back(index);
  };
  add(*skin_bone(editor));
  if (kind != BrushKind::JointCapsule)
    for (const int bone : editor.selection.bones) add(bone);
  settings.locked.assign(weights.bones().size(), 0);
  for (std::size_t bone = 0; bone < settings.locked.size(); ++bone) settings.locked[bone] = is_locked(document, weights.bones()[bone]);
  settings.normalize = normalize_of(editor);
  settings.relative_to_locks = painting.relative_to_locks;

  BrushFilter& filter = settings.filter;
  filter.depth = painting.depth;
  filter.depth_mm = painting.depth_mm;
  if (painting.tissue != PaintedTissue::All) {
    filter.labels.assign(65536, 0);
    for (const Tissue& tissue : document.tissues->tissues) {
      const bool visible = !editor.views->scene.looks || (*editor.views->scene.looks)[tissue.label].visible;
      const bool allowed = painting.tissue == PaintedTissue::Visible  ? visible
                           : painting.tissue == PaintedTissue::Chosen ? editor.selection.tissues.contains(tissue.label)
                                                                      : visible && !is_bone(tissue.kind);
      filter.labels[tissue.label] = allowed;
    }
  }
  if (const Visibility* visibility = document.visibility.get()) {
    if (visibility->clip_box.enabled) filter.box = BrushFilter::Box{visibility->clip_box.low, visibility->clip_box.high};
    if (visibility->clip_plane.enabled) filter.plane = BrushFilter::Plane{visibility->clip_plane.point, visibility->clip_plane.normal};
  }
  const auto region = painted_region(editor);
  if (painting.subtree && editor.views->tissue_voxels) {
    filter.allows = [region, weights = document.weights, tissue = editor.views->tissue_voxels, own = bones_about(*document.armature, *skin_bone(editor), *document.weights)](std::int64_t place, const glm::ivec3& voxel) {
      if (region && (*region)[static_cast<std::size_t>(place)] == 0) return false;
      const int brick = tissue->brick_at(voxel);
      return own[weights->chunk(brick)[static_cast<std::size_t>(place - tissue->bricks()[static_cast<std::size_t>(brick)].first)].bone[0]] != 0;
    };
  } else if (region) filter.allows = [region](std::int64_t place, const glm::ivec3&) { return (*region)[static_cast<std::size_t>(place)] != 0; };
  if (editor.handling->x_mirror) settings.mirror = mirror_plane(*document.armature);
  return settings;
}

namespace {

void show_stroke(Editor& editor, Painting::Running& running) {
  const std::vector<int> dirty = running.stroke->take_dirty();
  if (dirty.empty()) return;
  if (const WeightLayers* layers = running.edited.layers.get()) {
    for (const int brick : dirty) {
      const SkinWeights::Influences is = running.stroke->chunk(brick);
      const auto& layer = running.edited.layer;
      const auto came_out = [&] {
        if (!layer) return composed_over_base(*layers, brick, is);
        if (running.of == Painting::Running::Of::Mask) return composed_while_masked(*layers, *layer, brick, is);
        const SkinWeights::Influences was = running.before->chunk(brick);
        return running.of == Painting::Running::Of::Shares ? composed_while_shared(*layers, *layer, brick, was, is) : composed_while_painted(*layers, *layer, brick, was, is);
      };
      running.shown->set_chunk(brick, came_out());
    }
    editor.views->preview_weights = std::make_shared<const SkinWeights>(*running.shown);
  } else {
    editor.views->preview_weights = std::make_shared<const SkinWeights>(running.stroke->weights());
  }
  editor.touch();
}

void drop_stroke(Editor& editor) {
  editor.skin->painting->running.reset();
  editor.views->preview_weights.reset();
  editor.touch();
}

// Dabs at what lies under the pixels on the pointer's way.
void paint_to(Editor& editor, const glm::vec2& pixel) {
  Painting& painting = *editor.skin->painting;
  Painting::Running& running = *painting.running;
  const SeenFrom seen(editor, running.view);
  const glm::dvec3 reference = painting.place ? painting.place->seen : editor.views->cross_hair;
  const double radius_seen = painting.radius / std::max(seen.millimetres_per_pixel(reference), 1e-6);
  const int steps = std::clamp(static_cast<int>(std::ceil(glm::distance(pixel, running.pixel) / std::max(kStepOfRadius * radius_seen, 1.0))), 1, kMostSteps);
  for (int step = 1; step <= steps; ++step) {
    const auto place = brush_place(editor, running.view, glm::mix(running.pixel, pixel, float(step) / float(steps)));
    painting.place = place;
    if (place) running.stroke->to(place->rest);
    else running.stroke->lift();
  }
  running.pixel = pixel;
  show_stroke(editor, running);
}

void end_stroke(Editor& editor) {
  const std::shared_ptr<Painting::Running> running = editor.skin->painting->running;
  Stroke& stroke = *running->stroke;
  const bool empty = stroke.empty();
  const int lock = stroke.blocked_count() > 0 ? stroke.blocked_by() : -1;
  if (!empty) {
    const SkinWeights after = stroke.finish();
    if (running->of == Painting::Running::Of::Canvas) {
      commit_weights(editor, running->label, running->edited, edited_layers(running->edited, std::make_shared<const SkinWeights>(after)));
    } else {
      WeightLayers next = *running->edited.layers;
      auto& layer = next.layers[*running->edited.layer];
      layer = std::make_shared<const WeightLayer>(running->of == Painting::Running::Of::Mask ? mask_painted_on(next, *running->edited.layer, *running->before, after)
                                                                                             : shares_painted_on(*layer, *running->before, after));
      commit_layers(editor, running->label, std::move(next));
    }
  }
  drop_stroke(editor);
  if (!empty || lock < 0 || running->of == Painting::Running::Of::Mask) return;
  if (running->of == Painting::Running::Of::Shares && !is_locked(running->document, running->before->bones()[lock])) {
    editor.messages.toast_error("The layer is full here", "Its other bones keep what they have while normalizing is left to the composition", "skin.normalize_unlocked");
  } else {
    editor.messages.toast_error(lock_message(running->bones, lock), "Nothing else can take or give the weight here", "skin.unlock_all");
  }
}

// What lies below takes the place before all bones; of these only the painted ones may change.
void keep_other_bones(const Armature& armature, StrokeSettings& settings) {
  BoneSet kept(settings.locked.size() + 1, 1);
  kept[kBelow] = 0;
  const std::vector<int> pairs = mirror_pairs(armature);
  const auto may_change = [&](int bone) { kept[bone + 1] = settings.locked[bone]; };
  for (const int bone : settings.bones) {
    may_change(bone);
    if (settings.mirror) may_change(pairs[bone]);
    if (settings.brush.kind == BrushKind::JointCapsule && armature.bones[bone].parent >= 0) may_change(armature.bones[bone].parent);
  }
  settings.locked = std::move(kept);
  for (int& bone : settings.bones) ++bone;
  settings.relative_to_locks = false;
}

}  // namespace

void begin_stroke(Editor& editor, BrushKind kind) {
  const ViewPlace* view = hovered_view(editor);
  if (!view || !why_not_paint(editor).empty()) return;
  if (editor.skin->painting->mask && active_layer(editor) && kind == BrushKind::JointCapsule) return editor.messages.info("Paint", "A joint capsule paints bones: choose another brush for the mask");
  auto running = std::make_shared<Painting::Running>();
  running->document = editor.document();
  running->tissue = parted_tissue(editor);
  running->view = *view;
  running->pixel = editor.input.pointer;
  const Document& document = running->document;
  const int bone = *skin_bone(editor);
  running->edited = layer_to_edit(editor);
  running->label = std::string(name_of(kind)) + " " + document.armature->bones[bone].name;
  StrokeSettings settings = stroke_settings(editor, kind);
  running->before = running->edited.weights;
  running->bones = *document.armature;
  if (running->edited.layers) running->shown = *document.weights;
  if (editor.skin->painting->mask && running->edited.layer) {
    const WeightLayer& layer = *running->edited.layers->layers[*running->edited.layer];
    running->label = std::string(name_of(kind)) + " mask of " + layer.name;
    running->of = Painting::Running::Of::Mask;
    running->before = std::make_shared<const SkinWeights>(mask_as_weights(layer));
    running->bones.bones.clear();
    for (const std::string& name : running->before->bones()) running->bones.bones.push_back({.name = name, .tail = {0, 0, 1}});
    settings.bones = {kCovering};
    settings.locked.clear();
    settings.rigid_bone_tissue = false;
    settings.relative_to_locks = false;
  } else if (settings.normalize == Normalize::WhenComposed) {
    running->of = Painting::Running::Of::Shares;
    running->before = std::make_shared<const SkinWeights>(shares_as_weights(*running->edited.layers->layers[*running->edited.layer]));
    running->bones = with_below(*document.armature);
    keep_other_bones(*document.armature, settings);
  }
  running->stroke = std::make_unique<Stroke>(StrokeBody{*document.volume, *running->tissue, *document.tissues, running->bones}, running->before, settings);
  editor.skin->painting->running = running;
  paint_to(editor, editor.input.pointer);
  editor.drag = Drag{MouseButton::Left, [](Editor& e, const glm::vec2&) { paint_to(e, e.input.pointer); }, end_stroke, drop_stroke};
}

int dabs_of_stroke(const Editor& editor) {
  const auto& running = editor.skin->painting->running;
  return running ? running->stroke->dab_count() : 0;
}

void follow_brush(Editor& editor) {
  Painting& painting = *editor.skin->painting;
  editor.skin->ring = 0;
  if (!painting.running) {
    painting.place.reset();
    const ViewPlace* view = hovered_view(editor);
    const bool works = editor.seams->brush ? why_not_cut(editor).empty() : why_not_paint(editor).empty();
    if (editor.workspace != Workspace::Skin || !view || (editor.drag && !editor.seams->running) || editor.dialog || !works) return;
    painting.place = brush_place(editor, *view, editor.input.pointer);
  }
  if (!painting.place) return;
  for (const ViewPlace& view : editor.layout.view_places)
    if (view.id == painting.place->view) editor.skin->ring = static_cast<float>(painting.radius / SeenFrom(editor, view).millimetres_per_pixel(painting.place->seen));
}

void draw_brush(Editor& editor, const ViewPlace& view) {
  const Painting& painting = *editor.skin->painting;
  if (!painting.place || painting.place->view != view.id || editor.modal) return;
  const SeenFrom seen(editor, view);
  const GizmoPainter painter(editor, seen);
  const BrushPlace& place = *painting.place;
  // Upon the body, where the part that finds none of it is faint; in a slice a circle.
  const auto line = [&](const std::vector<RingPoint>& points, float alpha, float width, bool dashed) {
    for (const bool under : {true, false})
      for (std::size_t i = 0; i < points.size(); ++i) {
        const RingPoint &from = points[i], &to = points[(i + 1) % points.size()];
        const float seen_so = alpha * (from.on_body && to.on_body ? 1.0f : 0.4f);
        if (dashed && (under || i % 4 >= 2)) continue;
        painter.line(from.at, to.at, under ? with_alpha(0xFF000000, 0.55f * seen_so) : with_alpha(0xFFFFFFFF, seen_so), under ? width + 1.6f : width);
      }
  };
  const auto ring = [&](const glm::dvec3& centre, float alpha) {
    if (view.id == ViewId::Body) {
      BrushPlace there = place;
      if (centre != place.seen) there.normal = mirror_plane(*editor.document().armature).direction(place.normal);
      there.seen = centre;
      line(ring_on_body(editor, there, painting.radius, kRingPoints), alpha, 2, false);
      line(ring_on_body(editor, there, painting.radius / 2, kRingPoints), 0.7f * alpha, 1.2f, true);
      return;
    }
    const Ring rim = ring_at(place, centre, painting.radius), half = ring_at(place, centre, painting.radius / 2);
    painter.ring(rim, with_alpha(0xFF000000, 0.55f * alpha), 3.6f, GizmoPainter::Part::Whole);
    painter.ring(rim, with_alpha(0xFFFFFFFF, alpha), 2, GizmoPainter::Part::Whole);
    for (int i = 0; i < kRingPoints; i += 4) painter.arc(half, i * 2 * M_PI / kRingPoints, 2 * 2 * M_PI / kRingPoints, with_alpha(0xFFFFFFFF, 0.7f * alpha), 1.2f);
  };
  ring(place.seen, 1);
  painter.dot(place.seen, 0xFFFFFFFF, with_alpha(0xFF000000, 0.55f), 2.5f);
  if (view.id == ViewId::Body) painter.line(place.seen, place.seen + place.normal * (22.0 * editor.look.scale * seen.millimetres_per_pixel(place.seen)), with_alpha(0xFFFFFFFF, 0.8f), 1.5f);
  if (editor.handling->x_mirror && !editor.views->scene.pose && !editor.seams->brush) {
    const glm::dvec3 other = mirrored(*editor.document().armature, place.seen);
    if (seen.shows(other)) ring(other, 0.5f);
  }
}

}  // namespace limber::editor
