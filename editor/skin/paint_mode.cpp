// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/paint_mode.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/context/pointer_context.h"
#include "editor/context/screen.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/input/keymap.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/brush_cursor.h"
#include "editor/skin/label_strokes.h"
#include "editor/skin/painting.h"
#include "editor/skin/seam_brush.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/draw.h"
#include "editor/ui/messages.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr int kRingPoints = 64;
// Distance between the points of the pointer's path at which the brush paints, relative to the brush's radius.
constexpr double kStepOfRadius = 0.5;
constexpr int kMostSteps = 24;  // one movement of the pointer paints at no more points than this

// Returns the mirror image of the point on the other side of the body. With X mirror on, a stroke paints there too.
glm::dvec3 mirrored(const Armature& armature, const glm::dvec3& point) { return mirror_plane(armature).place(point); }

// Returns the brush's circle around `centre` in the plane perpendicular to the surface normal.
Ring ring_at(const BrushPlace& place, const glm::dvec3& centre, double radius) {
  const glm::dvec3 axis = glm::normalize(place.normal),
                   other = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  return {centre, axis, glm::normalize(glm::cross(axis, other)), radius};
}

}  // namespace

struct Painting::Running {
  // Copy of the document from the moment when the stroke began.
  Document document;
  std::shared_ptr<const TissueVoxels> tissue;
  LayerToEdit edited;
  // The quantity that the stroke paints. Canvas: the composed weights of the layer and all layers below it. Mask: the
  // layer's mask. Shares: the painted bone's weight in the layer itself, while the layer's other bones keep their
  // weights. A stroke can paint only weights of bones, so `before` and `bones` represent a mask or shares as bone
  // weights.
  enum class Of { Canvas, Mask, Shares } of = Of::Canvas;
  std::shared_ptr<const SkinWeights> before;
  Armature bones;
  std::optional<SkinWeights> shown;  // composed weights of all layers including the stroke; none: there are no layers
  BrushKind kind{};
  std::unique_ptr<Stroke> stroke;
  ViewPlace view;
  std::string label;
  glm::vec2 pixel{0};  // position of the pointer up to which the stroke has painted
};

namespace {

void show_stroke(Context& context, Painting::Running& running) {
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
        return running.of == Painting::Running::Of::Shares ? composed_while_shared(*layers, *layer, brick, was, is)
                                                           : composed_while_painted(*layers, *layer, brick, was, is);
      };
      running.shown->set_chunk(brick, came_out());
    }
    context.views->preview_weights = std::make_shared<const SkinWeights>(*running.shown);
  } else {
    context.views->preview_weights = std::make_shared<const SkinWeights>(running.stroke->weights());
  }
  context.ui->touch();
}

void drop_stroke(Context& context) {
  context.skin->painting->running.reset();
  context.views->preview_weights.reset();
  context.ui->touch();
}

// Paints along a straight line from the pixel of the last call to this pixel.
void paint_to(Context& context, const glm::vec2& pixel) {
  Painting& painting = *context.skin->painting;
  Painting::Running& running = *painting.running;
  const ViewProjection seen(context, running.view);
  const glm::dvec3 reference = painting.place ? painting.place->seen : context.views->cross_hair;
  const double radius_seen = painting.radius / std::max(seen.millimetres_per_pixel(reference), 1e-6);
  const int steps = std::clamp(
      static_cast<int>(std::ceil(glm::distance(pixel, running.pixel) / std::max(kStepOfRadius * radius_seen, 1.0))), 1,
      kMostSteps);
  for (int step = 1; step <= steps; ++step) {
    const auto place = brush_place(context, running.view, glm::mix(running.pixel, pixel, float(step) / float(steps)));
    painting.place = place;
    if (place) running.stroke->to(place->rest);
    else running.stroke->lift();
  }
  running.pixel = pixel;
  show_stroke(context, running);
}

void end_stroke(Context& context) {
  const std::shared_ptr<Painting::Running> running = context.skin->painting->running;
  Stroke& stroke = *running->stroke;
  const bool empty = stroke.empty();
  const int lock = stroke.blocked_count() > 0 ? stroke.blocked_by() : -1;
  if (!empty) {
    const SkinWeights after = stroke.finish();
    if (running->of == Painting::Running::Of::Canvas) {
      commit_weights(context, running->label, running->edited,
                     edited_layers(running->edited, std::make_shared<const SkinWeights>(after)));
    } else {
      WeightLayers next = *running->edited.layers;
      auto& layer = next.layers[*running->edited.layer];
      layer = std::make_shared<const WeightLayer>(
          running->of == Painting::Running::Of::Mask
              ? mask_painted_on(next, *running->edited.layer, *running->before, after)
              : shares_painted_on(*layer, *running->before, after));
      commit_layers(context, running->label, std::move(next));
    }
  }
  drop_stroke(context);
  if (!empty || lock < 0 || running->of == Painting::Running::Of::Mask) return;
  if (running->of == Painting::Running::Of::Shares && !is_locked(running->document, running->before->bones()[lock])) {
    context.messages->toast_error("The layer's weights here already sum to 1",
                                  "Normalize is off, so strokes do not take weight from the layer's other bones",
                                  "skin.normalize_unlocked");
  } else {
    context.messages->toast_error(lock_message(running->bones, lock),
                                  "No other unlocked bone can give or take weight here", "skin.unlock_all");
  }
}

// Prepares a stroke that changes only the painted bones of a layer: locks all its other bones. Bone indices move up by
// 1 to make room for kBelow, an extra first bone that stands for the weights of the layers below.
void keep_other_bones(const Armature& armature, StrokeSettings& settings) {
  BoneSet kept(settings.locked.size() + 1, 1);
  kept[kBelow] = 0;
  const std::vector<int> pairs = mirror_pairs(armature);
  const auto may_change = [&](int bone) { kept[bone + 1] = settings.locked[bone]; };
  for (const int bone : settings.bones) {
    may_change(bone);
    if (settings.mirror) may_change(pairs[bone]);
    if (settings.brush.kind == BrushKind::JointCapsule && armature.bones[bone].parent >= 0)
      may_change(armature.bones[bone].parent);
  }
  settings.locked = std::move(kept);
  for (int& bone : settings.bones) ++bone;
  settings.relative_to_locks = false;
}

}  // namespace

void begin_stroke(Context& context, BrushKind kind) {
  const ViewPlace* view = hovered_view(context);
  if (!view || !why_not_paint(context).empty()) return;
  if (context.skin->painting->mask && active_layer(context) && kind == BrushKind::JointCapsule)
    return context.messages->info("Paint", "The joint capsule brush cannot paint masks: select another brush");
  auto running = std::make_shared<Painting::Running>();
  running->kind = kind;
  running->document = context.document();
  running->tissue = parted_tissue(context);
  running->view = *view;
  running->pixel = context.ui->input.pointer;
  const Document& document = running->document;
  const int bone = *skin_bone(context);
  running->edited = layer_to_edit(context);
  running->label = std::string(name_of(kind)) + " " + document.armature->bones[bone].name;
  StrokeSettings settings = stroke_settings(context, kind);
  running->before = running->edited.weights;
  running->bones = *document.armature;
  if (running->edited.layers) running->shown = *document.weights;
  if (context.skin->painting->mask && running->edited.layer) {
    const WeightLayer& layer = *running->edited.layers->layers[*running->edited.layer];
    running->label = std::string(name_of(kind)) + " mask of " + layer.name;
    running->of = Painting::Running::Of::Mask;
    running->before = std::make_shared<const SkinWeights>(mask_as_weights(layer));
    running->bones.bones.clear();
    for (const std::string& name : running->before->bones())
      running->bones.bones.push_back({.name = name, .tail = {0, 0, 1}});
    settings.bones = {kCovering};
    settings.locked.clear();
    settings.rigid_bone_tissue = false;
    settings.relative_to_locks = false;
  } else if (settings.normalize == Normalize::WhenComposed) {
    running->of = Painting::Running::Of::Shares;
    running->before =
        std::make_shared<const SkinWeights>(shares_as_weights(*running->edited.layers->layers[*running->edited.layer]));
    running->bones = with_below(*document.armature);
    keep_other_bones(*document.armature, settings);
  }
  running->stroke = std::make_unique<Stroke>(
      WeightedBody{*document.volume, *running->tissue, *document.tissues, running->bones}, running->before, settings);
  context.skin->painting->running = running;
  paint_to(context, context.ui->input.pointer);
  context.interaction->drag =
      Drag{MouseButton::Left, [](Context& c, const glm::vec2&) { paint_to(c, c.ui->input.pointer); }, end_stroke,
           drop_stroke};
}

int dabs_of_stroke(const SkinDisplay& skin) {
  const auto& running = skin.painting->running;
  return running ? running->stroke->dab_count() : 0;
}

void follow_brush(Context& context) {
  Painting& painting = *context.skin->painting;
  context.skin->ring = 0;
  LabelBrush& labels = *painting.labels;
  // Switches the label brush off, because the user selected the seam brush after it.
  if (context.seams->brush) labels.on = false;
  if (!painting.running && !labels.running) {
    painting.place.reset();
    const ViewPlace* view = hovered_view(context);
    const bool works = labels.on              ? why_not_paint_labels(context).empty()
                       : context.seams->brush ? why_not_cut(context).empty()
                                              : why_not_paint(context).empty();
    if (context.workspace() != Workspace::Skin || !view || (context.interaction->drag && !context.seams->running) ||
        context.dialogs->shown || !works)
      return;
    painting.place = labels.on ? label_brush_place(context, *view, context.ui->input.pointer)
                               : brush_place(context, *view, context.ui->input.pointer);
  }
  if (!painting.place) return;
  for (const ViewPlace& view : context.screen->layout.view_places)
    if (view.id == painting.place->view)
      context.skin->ring = static_cast<float>(
          painting.radius / ViewProjection(context, view).millimetres_per_pixel(painting.place->seen));
}

namespace {

// The effect of the stroke that is being painted or, between strokes, of the next stroke. It depends on the modifier
// keys that are held: the stroke has the effect of the selected brush, subtracts, or smooths.
enum class StrokeEffect { OfBrush, TakesAway, Smooths };

StrokeEffect effect_of_kind(BrushKind brush, BrushKind stroke) {
  if (stroke == brush) return StrokeEffect::OfBrush;
  return stroke == BrushKind::Subtract ? StrokeEffect::TakesAway
         : stroke == BrushKind::Smooth ? StrokeEffect::Smooths
                                       : StrokeEffect::OfBrush;
}

StrokeEffect effect_of_stroke(const Context& context) {
  const Painting& painting = *context.skin->painting;
  if (painting.running) return effect_of_kind(painting.kind, painting.running->kind);
  const std::string* id = nullptr;
  for (const Chord::Kind kind : {Chord::Kind::Drag, Chord::Kind::Press})
    if (!id)
      id = context.keymap->find({kind, context.ui->input.modifiers(), Key::None, MouseButton::Left}, contexts(context));
  const bool subtracts = id && *id == "skin.paint_subtract", smooths = id && *id == "skin.paint_smooth";
  if (painting.labels->on) return subtracts ? StrokeEffect::TakesAway : StrokeEffect::OfBrush;
  if (context.seams->brush) return subtracts || smooths ? StrokeEffect::TakesAway : StrokeEffect::OfBrush;
  if (smooths) return effect_of_kind(painting.kind, BrushKind::Smooth);
  return subtracts && painting.kind != BrushKind::Subtract ? StrokeEffect::TakesAway : StrokeEffect::OfBrush;
}

// Draws the sign of a stroke's effect at the brush's centre, with a dark edge: a minus, or a drop for smoothing.
void draw_sign(const Look& look, const glm::vec2& at, StrokeEffect effect, Colour colour) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (const bool is_edge : {true, false}) {
    const Colour shade = is_edge ? with_alpha(0xFF000000, 0.55f) : colour;
    const float more = is_edge ? look.px(1) : 0;
    if (effect == StrokeEffect::TakesAway) {
      const glm::vec2 half{look.px(5) + more, look.px(1) + more};
      list->AddRectFilled(im(at - half), im(at + half), shade);
    } else {
      const float radius = look.px(3.5f) + more, top = look.px(6.5f) + 2 * more;
      const glm::vec2 middle = at + glm::vec2(0, look.px(2));
      list->AddCircleFilled(im(middle), radius, shade);
      list->AddTriangleFilled(im(middle + glm::vec2(-0.87f * radius, -0.5f * radius)), im(middle - glm::vec2(0, top)),
                              im(middle + glm::vec2(0.87f * radius, -0.5f * radius)), shade);
    }
  }
}

// Draws the brush's ring, and inside it a dashed ring at half of its radius, around a point of the shown body.
class RingPainter {
 public:
  RingPainter(Context& context, const ViewProjection& seen, Colour colour)
      : context_(context),
        seen_(seen),
        painter_(context, seen),
        colour_(colour) {}

  // In the 3D view, the ring follows the body's surface. Parts of the ring without a surface below them are faint. In a
  // slice, the ring is a plain circle.
  void ring(const glm::dvec3& centre, float alpha) const {
    const Painting& painting = *context_.skin->painting;
    const BrushPlace& place = *painting.place;
    const double radius = painting.radius;
    // The label brush paints the same label everywhere in the ball, so it has no ring of half its effect.
    const bool fades = !painting.labels->on;
    if (seen_.place.id == ViewId::Body) {
      BrushPlace there = place;
      if (centre != place.seen) there.normal = mirror_plane(*context_.document().armature).direction(place.normal);
      there.seen = centre;
      line(ring_on_body(context_.views, there, radius, kRingPoints), alpha, 2, false);
      if (fades) line(ring_on_body(context_.views, there, radius / 2, kRingPoints), 0.7f * alpha, 1.2f, true);
      return;
    }
    const Ring rim = ring_at(place, centre, radius), half = ring_at(place, centre, radius / 2);
    painter_.ring(rim, with_alpha(0xFF000000, 0.55f * alpha), 3.6f, GizmoPainter::Part::Whole);
    painter_.ring(rim, with_alpha(colour_, alpha), 2, GizmoPainter::Part::Whole);
    for (int i = 0; i < kRingPoints && fades; i += 4)
      painter_.arc(half, i * 2 * M_PI / kRingPoints, 2 * 2 * M_PI / kRingPoints, with_alpha(colour_, 0.7f * alpha),
                   1.2f);
  }

 private:
  void line(const std::vector<RingPoint>& points, float alpha, float width, bool dashed) const {
    for (const bool under : {true, false})
      for (std::size_t i = 0; i < points.size(); ++i) {
        const RingPoint &from = points[i], &to = points[(i + 1) % points.size()];
        const float seen_so = alpha * (from.on_body && to.on_body ? 1.0f : 0.4f);
        if (dashed && (under || i % 4 >= 2)) continue;
        painter_.line(from.at, to.at, under ? with_alpha(0xFF000000, 0.55f * seen_so) : with_alpha(colour_, seen_so),
                      under ? width + 1.6f : width);
      }
  }

  Context& context_;
  const ViewProjection& seen_;
  GizmoPainter painter_;
  Colour colour_;
};

}  // namespace

void draw_brush(Context& context, const ViewPlace& view) {
  const Painting& painting = *context.skin->painting;
  if (!painting.place || painting.place->view != view.id || context.interaction->modal) return;
  const ViewProjection seen(context, view);
  const GizmoPainter painter(context, seen);
  const BrushPlace& place = *painting.place;
  const StrokeEffect effect = effect_of_stroke(context);
  const Colour colour = effect == StrokeEffect::TakesAway ? kViewError
                        : effect == StrokeEffect::Smooths ? kViewAccent
                                                          : 0xFFFFFFFF;
  const RingPainter rings(context, seen, colour);
  rings.ring(place.seen, 1);
  if (view.id == ViewId::Body)
    painter.line(place.seen,
                 place.seen + place.normal * (22.0 * context.ui->look.scale * seen.millimetres_per_pixel(place.seen)),
                 with_alpha(colour, 0.8f), 1.5f);
  if (effect == StrokeEffect::OfBrush) painter.dot(place.seen, colour, with_alpha(0xFF000000, 0.55f), 2.5f);
  else if (const auto at = seen.pixel_of(place.seen)) draw_sign(context.ui->look, glm::vec2(*at), effect, colour);
  if (context.transform_settings->x_mirror && !context.views->scene.pose && !context.seams->brush &&
      !painting.labels->on) {
    const glm::dvec3 other = mirrored(*context.document().armature, place.seen);
    if (seen.shows(other)) rings.ring(other, 0.5f);
  }
}

}  // namespace limber::editor
