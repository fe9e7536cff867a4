// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/selection/bone_name_overlay.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/widgets.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

// Sizes of the names, the gizmo and the drawn axes, pixels at scale 1.
constexpr float kShortest = 40;                        // a bone that looks shorter has a name only while it is selected
constexpr float kBeside = 10, kHeight = 16, kPad = 4;  // gap between bone and name; height and padding of a name
constexpr float kGizmo = 114, kJointGizmo = 136;       // radius of the gizmo without and with joint handles
// Length of the drawn bone axes: this fraction of the bone's length, but at most kLongestAxis.
constexpr double kAxisShare = 0.25, kLongestAxis = 36;

// A bone that the 3D view shows, projected into the view.
struct SeenBone {
  int bone;
  glm::vec2 head, tail;  // positions of the bone's ends in the view, pixels
  double depth;          // position of the bone's middle along the direction to the eye, mm; larger is nearer
  bool chosen, active;
};

std::vector<SeenBone> seen_bones(const Context& context, const ViewProjection& view) {
  const render::Scene& scene = context.views->scene;
  std::vector<SeenBone> seen;
  for (int b = 0; b < std::ssize(scene.armature->bones); ++b) {
    const Bone& bone = scene.armature->bones[b];
    const RigidTransform posed = b < std::ssize(scene.posed_from_rest) ? scene.posed_from_rest[b] : RigidTransform{};
    const glm::dvec3 head = posed * bone.head, tail = posed * bone.tail;
    const auto from = view.pixel_of(head), to = view.pixel_of(tail);
    const bool chosen = scene.bones[b].selected;
    if (!from || !to || (!chosen && glm::distance(*from, *to) < kShortest * context.ui->look.scale)) continue;
    seen.push_back({b, glm::vec2(*from), glm::vec2(*to), glm::dot((head + tail) / 2.0, view.towards_eye), chosen,
                    scene.bones[b].active});
  }
  // Names are placed in this order: the active bone, then selected bones, then bones near the eye.
  std::sort(seen.begin(), seen.end(), [](const SeenBone& a, const SeenBone& b) {
    return std::tuple(!a.active, !a.chosen, -a.depth) < std::tuple(!b.active, !b.chosen, -b.depth);
  });
  return seen;
}

struct Circle {
  glm::vec2 centre;
  float radius;

  bool meets(const Rect& rect) const { return glm::distance(glm::clamp(centre, rect.low, rect.high), centre) < radius; }
};

class Names {
 public:
  Names(Context& context, const ViewProjection& view) : context_(context), inside_(view.place.rect) {
    const auto gizmo = gizmo_in(context, view);
    const auto centre = gizmo ? view.pixel_of(gizmo->centre) : std::nullopt;
    if (centre)
      gizmo_ = {glm::vec2(*centre),
                px(context.workspace() == Workspace::Rig && context.interaction->tool == Tool::Rotate ? kJointGizmo
                                                                                                      : kGizmo)};
    // Reserve the areas of the view's title, axis ball, scale bar and tool numbers, which bone names must not cover.
    taken_.push_back({inside_.low, inside_.low + glm::vec2(px(300), px(48))});
    if (context.views->axes)
      taken_.push_back({{inside_.high.x - px(100), inside_.low.y}, {inside_.high.x, inside_.low.y + px(104)}});
    if (context.views->scale_bar) taken_.push_back({inside_.high - glm::vec2(px(170), px(52)), inside_.high});
    if (context.interaction->modal && centre)
      taken_.push_back(place_of_read_out(context.ui->look, inside_, gizmo_->centre));
  }

  void put(const SeenBone& bone, const std::string& name) {
    const Look& look = context_.ui->look;
    const glm::vec2 size{std::ceil(text_size(look.fonts.small, name).x) + px(2 * kPad), px(kHeight)};
    const auto place = place_for(bone, size);
    if (!place) return;
    taken_.push_back(*place);
    register_widget(context_.ui, "bone name " + name, *place);
    fill(*place, with_alpha(look.theme.view_plate, 0.7f), px(3));
    put_text(context_.ui, look.fonts.small, bone.active ? look.theme.select_light : look.theme.view_text,
             Rect{{place->low.x + px(kPad), place->low.y}, {place->high.x, place->high.y}}, name);
  }

 private:
  float px(float size) const { return context_.ui->look.px(size); }

  bool is_free(const Rect& rect) const {
    return inside_.contains(rect) && !(gizmo_ && gizmo_->meets(rect)) &&
           std::none_of(taken_.begin(), taken_.end(), [&](const Rect& other) { return other.overlaps(rect); });
  }

  // Returns a free rectangle for a bone's name. First tries positions beside the bone's middle, then beside points
  // nearer to its ends. For a selected bone, tries positions around the gizmo last. Returns nothing if no position is
  // free.
  std::optional<Rect> place_for(const SeenBone& bone, const glm::vec2& size) const {
    const auto free_at = [&](const glm::vec2& low) -> std::optional<Rect> {
      const Rect rect{glm::round(low), glm::round(low) + size};
      return is_free(rect) ? std::optional(rect) : std::nullopt;
    };
    for (const float share : {0.5f, 0.7f, 0.3f, 0.9f}) {
      const glm::vec2 at = glm::mix(bone.head, bone.tail, share);
      for (const float x : {px(kBeside), -px(kBeside) - size.x})
        if (const auto found = free_at({at.x + x, at.y - size.y / 2})) return found;
    }
    if (!gizmo_ || !bone.chosen) return std::nullopt;
    const glm::vec2 way = (bone.head + bone.tail) * 0.5f - gizmo_->centre;
    const float begin = glm::length(way) > 1 ? std::atan2(way.y, way.x) : 0;
    for (int turn = 0; turn < 8; ++turn) {
      const float angle = begin + static_cast<float>((turn % 2 ? 1 : -1) * ((turn + 1) / 2) * std::numbers::pi / 4);
      const glm::vec2 out(std::cos(angle), std::sin(angle));
      // The last term moves the whole rectangle out of the gizmo's circle, to the side of the direction `out`.
      if (const auto found = free_at(gizmo_->centre + out * (gizmo_->radius + px(4)) + (out - 1.0f) * size * 0.5f))
        return found;
    }
    return std::nullopt;
  }

  Context& context_;
  const Rect inside_;
  std::optional<Circle> gizmo_;
  std::vector<Rect> taken_;
};

// Draws the local axes of a bone as lines that start at the bone's tail, with the letters X, Y and Z at their ends.
void draw_axes(Context& context, const ViewProjection& view, const SeenBone& seen) {
  const render::Scene& scene = context.views->scene;
  const Bone& bone = scene.armature->bones[seen.bone];
  const RigidTransform posed =
      seen.bone < std::ssize(scene.posed_from_rest) ? scene.posed_from_rest[seen.bone] : RigidTransform{};
  const glm::dmat3 axes = glm::mat3_cast(posed.rotation) * rest_axes(bone);
  const glm::dvec3 tail = posed * bone.tail;
  const Look& look = context.ui->look;
  const double length = std::min(kAxisShare * glm::distance(bone.head, bone.tail),
                                 kLongestAxis * look.scale * view.millimetres_per_pixel(tail));
  const GizmoPainter painter(context, view);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 end = tail + axes[axis] * length,
                     beyond = tail + axes[axis] * (length + 7 * look.scale * view.millimetres_per_pixel(tail));
    painter.line(tail, end, look.theme.axis[axis], 1.6f);
    if (const auto at = view.pixel_of(beyond))
      put_text(context.ui, look.fonts.small, look.theme.axis[axis],
               Rect{glm::vec2(*at) - look.px(7), glm::vec2(*at) + look.px(7)}, std::string(1, "XYZ"[axis]),
               Align::Centre);
  }
}

}  // namespace

void draw_bone_labels(Context& context, const ViewProjection& view) {
  const Views& views = *context.views;
  if (view.place.id != ViewId::Body || !views.scene.armature || (!views.bone_names && !views.bone_axes)) return;
  const std::vector<SeenBone> bones = seen_bones(context, view);
  if (views.bone_axes)
    for (const SeenBone& bone : bones) draw_axes(context, view, bone);
  if (!views.bone_names) return;
  Names names(context, view);
  for (const SeenBone& bone : bones) names.put(bone, views.scene.armature->bones[bone.bone].name);
}

}  // namespace limber::editor
