// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/selection/transform_gizmo.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

#include "core/rig/anatomical_position.h"
#include "core/rig/joint_limits.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/pointer_context.h"
#include "editor/context/pose_editing.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_tools.h"
#include "editor/rig/joint_gizmo.h"
#include "editor/rig/rig_check.h"
#include "editor/rig/rig_edits.h"
#include "editor/rig/rig_transform_tool.h"
#include "editor/selection/bone_name_overlay.h"
#include "editor/shown/compare_wipe.h"
#include "editor/ui/draw.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

// Radii and lengths of the gizmo's parts in pixels at scale 1. kHit and kJointHit: largest distance of the pointer from
// a part, or from a joint, at which a click hits it.
constexpr double kRing = 86, kViewRing = 108, kTrackball = 78, kHit = 7;
constexpr double kArrowBegin = 16, kArrowEnd = 80, kCone = 12, kSquareAt = 28, kSquare = 12, kCentre = 9;
constexpr double kJointHit = 10;
// A ring is hidden when the angle between its plane and the line of sight is below 4 degrees, and fully opaque above 8
// degrees. These are the sines of the two angles.
constexpr double kHidden = 0.0698, kEdgeOn = 0.1392;
constexpr int kSteps = 96;

double distance_to_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, double& share) {
  const glm::dvec2 along = b - a;
  const double squared = glm::dot(along, along);
  share = squared > 0 ? glm::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0;
  return glm::distance(p, a + share * along);
}

// Returns how far the gizmo's ring about an axis is turned to the eye: 0 if the ring is seen edge-on, 1 if it faces the
// eye. The value is the sine of the angle between the line of sight and the ring's plane.
double steepness(const Gizmo& gizmo, const ViewProjection& view, int axis) {
  return std::abs(glm::dot(gizmo.axes[axis], view.direction_to_eye(gizmo.centre)));
}
float ring_alpha(const Gizmo& gizmo, const ViewProjection& view, int axis) {
  return static_cast<float>(glm::clamp((steepness(gizmo, view, axis) - kHidden) / (kEdgeOn - kHidden), 0.0, 1.0));
}
// Returns the opacity of an arrow, [0, 1]. An arrow that points at the eye is faded out, because it cannot be dragged.
float arrow_alpha(const Gizmo& gizmo, const ViewProjection& view, int axis) {
  const double s = steepness(gizmo, view, axis), across = std::sqrt(std::max(0.0, 1 - s * s));
  return static_cast<float>(glm::clamp((across - kHidden) / (kEdgeOn - kHidden), 0.0, 1.0));
}

// Finds the point on the front half of a ring that is drawn nearest to a pixel. Returns how much nearer to the eye this
// point is than the ring's centre, mm. Returns nothing if the ring is farther than `reach` pixels from the pixel.
std::optional<double> touched(const Ring& ring, const ViewProjection& view, const glm::dvec2& pixel, double reach) {
  const glm::dvec3 to_eye = view.direction_to_eye(ring.centre);
  const auto [begin, by] = ring.front(view);
  double best = reach;
  std::optional<double> nearness;
  glm::dvec3 from = ring.at(begin);
  auto from_pixel = view.pixel_of(from);
  for (int i = 1; i <= kSteps; ++i) {
    const glm::dvec3 to = ring.at(begin + by * i / kSteps);
    const auto to_pixel = view.pixel_of(to);
    double share = 0;
    if (from_pixel && to_pixel)
      if (const double distance = distance_to_segment(pixel, *from_pixel, *to_pixel, share); distance <= best) {
        best = distance;
        nearness = glm::dot(glm::mix(from, to, share) - ring.centre, to_eye);
      }
    from = to;
    from_pixel = to_pixel;
  }
  return nearness;
}

std::optional<GizmoPart> rotating_part(const Gizmo& gizmo, const ViewProjection& view, float scale,
                                       const glm::dvec2& pixel, const glm::dvec2& centre) {
  std::optional<GizmoPart> found;
  double nearest = -1e300;
  for (int axis = 0; axis < 3; ++axis) {
    if (steepness(gizmo, view, axis) < kEdgeOn) continue;
    const auto nearness =
        touched(ring_of(view, scale, gizmo.centre, gizmo.axes[axis], kRing), view, pixel, kHit * scale);
    if (nearness && *nearness > nearest) {
      nearest = *nearness;
      found = GizmoPart{GizmoPart::Kind::Ring, axis};
    }
  }
  if (found) return found;
  const double distance = glm::distance(pixel, centre) / scale;
  if (std::abs(distance - kViewRing) <= kHit) return GizmoPart{GizmoPart::Kind::ViewRing};
  if (distance <= kTrackball) return GizmoPart{GizmoPart::Kind::Trackball};
  return std::nullopt;
}

glm::dvec3 middle_of_square(const Gizmo& gizmo, int axis, double unit) {
  return gizmo.centre + (gizmo.axes[(axis + 1) % 3] + gizmo.axes[(axis + 2) % 3]) * (kSquareAt * unit);
}

std::optional<GizmoPart> moving_part(const Gizmo& gizmo, const ViewProjection& view, float scale,
                                     const glm::dvec2& pixel, const glm::dvec2& centre) {
  if (glm::distance(pixel, centre) <= (kCentre + kHit / 2) * scale) return GizmoPart{GizmoPart::Kind::Centre};
  const double unit = view.millimetres_per_pixel(gizmo.centre) * scale;
  const glm::dvec3 to_eye = view.direction_to_eye(gizmo.centre);
  std::optional<GizmoPart> found;
  double nearest = -1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const auto begin = view.pixel_of(gizmo.centre + gizmo.axes[axis] * (kArrowBegin * unit)),
               end = view.pixel_of(gizmo.centre + gizmo.axes[axis] * ((kArrowEnd + kCone) * unit));
    double share;
    if (begin && end && arrow_alpha(gizmo, view, axis) >= 1 &&
        distance_to_segment(pixel, *begin, *end, share) <= kHit * scale)
      if (const double nearness = glm::dot(gizmo.axes[axis], to_eye) * share; nearness > nearest) {
        nearest = nearness;
        found = GizmoPart{GizmoPart::Kind::Arrow, axis};
      }
  }
  if (found || gizmo.tool == Tool::Scale) return found;
  for (int axis = 0; axis < 3; ++axis) {
    const auto middle = view.pixel_of(middle_of_square(gizmo, axis, unit));
    if (middle && steepness(gizmo, view, axis) >= kEdgeOn && glm::distance(pixel, *middle) <= kSquare * scale * 0.8)
      return GizmoPart{GizmoPart::Kind::Plane, axis};
  }
  return std::nullopt;
}

// Returns the bone whose tail is drawn nearest to the pixel, at most kJointHit away. If no tail is that near, returns
// the bone under the pointer.
std::optional<int> joint_at(const Context& context, const ViewProjection& view, const glm::dvec2& pixel) {
  const Armature& armature = *context.document().armature;
  const auto posed = posed_from_rest(armature, seen_pose(context));
  std::optional<int> found;
  double nearest = kJointHit * context.ui->look.scale;
  for (int bone = 0; bone < std::ssize(armature.bones); ++bone)
    if (const auto tail = view.pixel_of(posed[bone] * armature.bones[bone].tail);
        tail && view.shows(posed[bone] * armature.bones[bone].tail) && glm::distance(*tail, pixel) <= nearest) {
      nearest = glm::distance(*tail, pixel);
      found = bone;
    }
  return found ? found : bone_at_pointer(context);
}

bool press_joint(Context& context, const ViewProjection& view) {
  const auto bone = joint_at(context, view, glm::dvec2(context.ui->input.pointer));
  if (!bone) return false;
  choose_bone(context, *bone);
  begin_tool(context, begin_dragging(context, {.held = MouseButton::Left}));
  return true;
}

void draw_rotating(const Gizmo& gizmo, const ViewProjection& view, const Context& context, const GizmoPainter& painter,
                   const std::optional<GizmoPart>& hovered) {
  const Theme& theme = context.ui->look.theme;
  const float scale = context.ui->look.scale;
  const auto over = [&](GizmoPart::Kind kind, int axis = -1) { return hovered && *hovered == GizmoPart{kind, axis}; };
  const auto centre = view.pixel_of(gizmo.centre);
  if (centre && over(GizmoPart::Kind::Trackball))
    ImGui::GetWindowDrawList()->AddCircleFilled({static_cast<float>(centre->x), static_cast<float>(centre->y)},
                                                static_cast<float>(kTrackball) * scale, with_alpha(0xFFFFFFFF, 0.06f),
                                                64);
  const bool seen = over(GizmoPart::Kind::ViewRing);
  painter.ring(ring_of(view, scale, gizmo.centre, view.towards_eye, kViewRing),
               with_alpha(theme.view_text, seen ? 1 : 0.55f), seen ? 2.5f : 1.5f, GizmoPainter::Part::Whole);
  // Draw rings that face the eye first, so that the thin ellipses of rings seen edge-on lie over them.
  int order[] = {0, 1, 2};
  std::sort(order, order + 3, [&](int a, int b) { return steepness(gizmo, view, a) > steepness(gizmo, view, b); });
  for (const int axis : order) {
    const bool on = over(GizmoPart::Kind::Ring, axis);
    const float alpha = ring_alpha(gizmo, view, axis);
    if (alpha > 0)
      painter.ring(ring_of(view, scale, gizmo.centre, gizmo.axes[axis], kRing),
                   with_alpha(theme.axis[axis], alpha * (on ? 1 : 0.8f)), on ? 3.5f : 2.5f, GizmoPainter::Part::Front);
  }
}

void draw_moving(const Gizmo& gizmo, const ViewProjection& view, const Context& context, const GizmoPainter& painter,
                 const std::optional<GizmoPart>& hovered) {
  const Theme& theme = context.ui->look.theme;
  const float scale = context.ui->look.scale;
  const double unit = view.millimetres_per_pixel(gizmo.centre) * scale;
  for (int axis = 0; axis < 3; ++axis) {
    const bool on = hovered && *hovered == GizmoPart{GizmoPart::Kind::Arrow, axis};
    if (const float alpha = arrow_alpha(gizmo, view, axis); alpha > 0)
      painter.arrow(gizmo.centre, gizmo.axes[axis], with_alpha(theme.axis[axis], alpha * (on ? 1 : 0.85f)), kArrowBegin,
                    kArrowEnd, on ? 3.5f : 2.5f, gizmo.tool == Tool::Scale);
    if (gizmo.tool == Tool::Scale || steepness(gizmo, view, axis) < kEdgeOn) continue;
    painter.square(
        middle_of_square(gizmo, axis, unit), gizmo.axes[(axis + 1) % 3] * (kSquare / 2 * unit),
        gizmo.axes[(axis + 2) % 3] * (kSquare / 2 * unit),
        with_alpha(theme.axis[axis], hovered && *hovered == GizmoPart{GizmoPart::Kind::Plane, axis} ? 1 : 0.6f));
  }
  painter.circle(gizmo.centre,
                 with_alpha(0xFFFFFFFF, hovered && *hovered == GizmoPart{GizmoPart::Kind::Centre} ? 1 : 0.85f), kCentre,
                 1.6f);
}

struct BonePart {
  int bone;
  TransformSettings::Part part;
};

// Returns the head or tail of a bone that is drawn nearest to the pixel, at most kJointHit away. Of ends at the same
// position, an end of the active bone is preferred. If no end is that near, returns the whole bone under the pixel;
// this works only in the 3D view.
std::optional<BonePart> bone_part_at(const Context& context, const ViewProjection& view, const glm::dvec2& pixel) {
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  if (context.workspace() != Workspace::Rig || !rig || !context.views->bones) return std::nullopt;
  std::optional<BonePart> found;
  double nearest = kJointHit * context.ui->look.scale;
  for (int bone = 0; bone < std::ssize(rig->bones); ++bone)
    for (const bool tail : {false, true}) {
      const glm::dvec3& place = place_of(*rig, {bone, tail});
      const auto seen = view.shows(place) ? view.pixel_of(place) : std::nullopt;
      // If several bone ends have the same position, the subtracted amounts prefer an end of the active bone, and a
      // tail to a head.
      const double distance =
          seen ? glm::distance(*seen, pixel) - (context.selection->bone == bone ? 1e-3 : 0) - (tail ? 5e-4 : 0) : 1e9;
      if (distance > nearest) continue;
      nearest = distance;
      found = BonePart{bone, tail ? TransformSettings::Part::Tail : TransformSettings::Part::Head};
    }
  if (found || view.place.id != ViewId::Body) return found;
  if (const auto bone =
          body_at_pointer(context, view.place).pick_bone(glm::ivec2(pixel - glm::dvec2(view.place.rect.low))))
    return BonePart{*bone, TransformSettings::Part::Whole};
  return std::nullopt;
}

// A bone that is drawn in slices, with its ends in world coordinates, mm. The ends are posed in the Pose workspace and
// at rest in the Rig workspace.
struct DrawnBone {
  int bone;
  glm::dvec3 head, tail;
};

std::vector<DrawnBone> bones_in_slices(const Context& context) {
  const bool posed = context.workspace() == Workspace::Pose;
  const std::shared_ptr<const Armature> rig = posed ? context.document().armature : shown_rig(context);
  std::vector<DrawnBone> drawn;
  if ((!posed && context.workspace() != Workspace::Rig) || !rig || !context.views->bones) return drawn;
  const std::vector<RigidTransform> moved =
      posed ? posed_from_rest(*rig, seen_pose(context)) : std::vector<RigidTransform>(rig->bones.size());
  for (int bone = 0; bone < std::ssize(rig->bones); ++bone)
    drawn.push_back({bone, moved[bone] * rig->bones[bone].head, moved[bone] * rig->bones[bone].tail});
  return drawn;
}

// Draws the bones as lines if the view is a slice; bones with no end near the slice are fainter. In the Rig workspace,
// also marks the selected joint in every view.
void draw_rig(Context& context, const ViewProjection& view) {
  const GizmoPainter painter(context, view);
  const Theme& theme = context.ui->look.theme;
  if (view.place.id != ViewId::Body)
    for (const DrawnBone& bone : bones_in_slices(context)) {
      const bool chosen = context.selection->bones.contains(bone.bone);
      const float alpha = view.shows(bone.head) || view.shows(bone.tail) ? 0.9f : 0.25f;
      const Colour colour = with_alpha(chosen ? theme.select : theme.view_text, alpha);
      painter.line(bone.head, bone.tail, colour, 2);
      for (const glm::dvec3& end : {bone.head, bone.tail}) painter.dot(end, colour, with_alpha(0xFF1A1614, alpha), 4);
    }
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  if (context.workspace() != Workspace::Rig || !rig || !context.views->bones) return;
  const auto bone = context.selection->bone;
  if (context.transform_settings->part == TransformSettings::Part::Whole || !bone || *bone >= std::ssize(rig->bones))
    return;
  const glm::dvec3& place = place_of(*rig, {*bone, context.transform_settings->part == TransformSettings::Part::Tail});
  if (view.shows(place)) painter.dot(place, theme.select_light, theme.select, 5);
}

// Begins a drag in the Rig workspace: the Move tool moves the joint or bone under the pointer, the Extrude tool
// extrudes a new bone from it. Returns false if another tool is active, or if no joint or bone is under the pointer.
bool press_rig(Context& context, const ViewProjection& view) {
  if (context.interaction->tool != Tool::Move && context.interaction->tool != Tool::Extrude) return false;
  const auto part = bone_part_at(context, view, glm::dvec2(context.ui->input.pointer));
  if (!part) return false;
  choose_bone(context, part->bone);
  context.transform_settings->part = part->part;
  begin_tool(context,
             begin_rig_change(context,
                              context.interaction->tool == Tool::Move ? chosen_change(context, RigChange::Kind::Move)
                                                                      : extrusion(context),
                              {.held = MouseButton::Left}));
  return true;
}

// The pole of a limb, which is the point towards which the limb's middle joint (elbow or knee) points. bone: the limb's
// last bone; middle: the posed position of the middle joint; point: the pole's position; world, mm.
struct Pole {
  int bone;
  glm::dvec3 middle, point;
};

std::vector<Pole> poles_of(const Context& context) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  if (context.workspace() != Workspace::Pose || !armature || !context.views->bones) return {};
  std::vector<Pole> poles;
  const auto posed = posed_from_rest(*armature, seen_pose(context));
  const auto& shown = context.transform_settings->shown_pole;
  for (const auto& [name, point] : anchors_of(context.document()).poles)
    if (const auto bone = armature->find(name))
      poles.push_back({*bone, posed[*bone] * armature->bones[*bone].head, shown.bone == name ? shown.place : point});
  return poles;
}

std::optional<int> pole_at(const Context& context, const ViewProjection& view, const glm::dvec2& pixel) {
  for (const Pole& pole : poles_of(context))
    if (const auto seen = view.pixel_of(pole.point);
        seen && glm::distance(*seen, pixel) <= kJointHit * context.ui->look.scale)
      return pole.bone;
  return std::nullopt;
}

// Draws marks in the 3D view of the Pose workspace: on pinned joints, and on poles (points towards which the middle
// joints of limbs point).
void draw_marks(Context& context, const ViewProjection& view) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  if (context.workspace() != Workspace::Pose || view.place.id != ViewId::Body || !armature || !context.views->bones)
    return;
  const GizmoPainter painter(context, view);
  if (const Anchors& anchors = anchors_of(context.document()); !anchors.pins.empty()) {
    const auto posed = posed_from_rest(*armature, seen_pose(context));
    for (const std::string& name : anchors.pins)
      if (const auto bone = armature->find(name))
        painter.diamond(posed[*bone] * armature->bones[*bone].tail, kViewAccent, 12);
  }
  for (const Pole& pole : poles_of(context)) {
    painter.line(pole.middle, pole.point, kViewAccent, 1, true);
    painter.dot(pole.point, kViewAccent, 0xFF1A1614, 5);
  }
}

// Radii of the drawn joint limits, pixels at scale 1. kLimits: hinge fan or ball joint's cone; kTwist: twist range.
constexpr double kLimits = 58, kTwist = 18;

// Draws the limits of the joint at the active bone's head: the range of a hinge as a fan, or the cone and the twist
// range of a ball joint. In the Rig workspace, the limits are drawn at rest. In the Pose workspace, the limits move
// with the parent bone, and are drawn only while Keep to joint limits is on.
void draw_limits(Context& context, const ViewProjection& view) {
  const bool posed = context.workspace() == Workspace::Pose;
  if (posed ? !context.posing->keep_limits || context.interaction->modal : context.workspace() != Workspace::Rig)
    return;
  const std::shared_ptr<const Armature> armature = posed ? context.document().armature : shown_rig(context);
  const auto chosen = context.selection->bone;
  if (view.place.id != ViewId::Body || !armature || !chosen || *chosen >= std::ssize(armature->bones) ||
      !context.views->bones)
    return;
  const Bone& bone = armature->bones[*chosen];
  RigidTransform carried;  // transform of the parent bone from the rest pose to the shown pose
  if (posed) {
    const Pose pose = seen_pose(context);
    carried = bone.parent < 0 ? RigidTransform{{1, 0, 0, 0}, pose.root_translation}
                              : posed_from_rest(*armature, pose)[bone.parent];
  }
  const JointLimits& limits = bone.limits;
  const GizmoPainter painter(context, view);
  const Colour line = with_alpha(kViewWarn, posed ? 0.6f : 0.9f), area = with_alpha(kViewWarn, posed ? 0.09f : 0.16f);
  const glm::dvec3 head = carried * bone.head, along = carried.rotation * (bone.tail - bone.head);
  if (limits.type == JointLimits::Type::Hinge) {
    const glm::dvec3 axis = carried.rotation * limits.axis, across = along - glm::dot(along, axis) * axis;
    Ring fan = ring_of(view, context.ui->look.scale, head, axis, kLimits);
    if (glm::length(across) < 1e-6) return;
    fan.from = glm::normalize(across);
    painter.sector(fan, limits.minimum, limits.maximum - limits.minimum, area);
    painter.arc(fan, limits.minimum, limits.maximum, line, 2);
    const double zero = hinge_angle_at_rest(*armature, *chosen, limits.axis);
    Ring rim = fan;
    rim.radius *= 1.25;
    for (const double end : {limits.minimum, limits.maximum}) {
      painter.line(fan.centre, fan.at(end), line, 1.4f);
      painter.word(rim.at(end), std::to_string(std::lround(glm::degrees(end + zero))) + "\u00b0", line);
    }
  }
  if (limits.type == JointLimits::Type::Ball) {
    const glm::dvec3 axis = carried.rotation * twist_axis(bone);
    Ring rim = ring_of(view, context.ui->look.scale, head, axis, kLimits);
    const double reach = rim.radius;
    rim.centre = head + axis * (reach * std::cos(limits.cone));
    rim.radius = reach * std::sin(limits.cone);
    painter.ring(rim, line, 2, GizmoPainter::Part::Whole);
    for (int spoke = 0; spoke < 8; ++spoke)
      painter.line(head, rim.at(spoke * glm::two_pi<double>() / 8), with_alpha(line, 0.4f), 1);
    const Ring twist = ring_of(view, context.ui->look.scale, head, axis, kTwist);
    painter.arc(twist, limits.twist_minimum, limits.twist_maximum, line, 2.5f);
  }
}

}  // namespace

std::optional<Gizmo> gizmo_in(const Context& context, const ViewProjection& view) {
  if (!context.document().volume || !context.views->bones) return std::nullopt;
  const std::shared_ptr<const Armature> armature = shown_rig(context);
  const auto bone = context.selection->bone;
  if (!armature || !bone || *bone >= std::ssize(armature->bones)) return std::nullopt;
  if (context.workspace() == Workspace::Rig &&
      (context.interaction->tool == Tool::Move || context.interaction->tool == Tool::Rotate ||
       context.interaction->tool == Tool::Scale)) {
    const glm::dvec3& place =
        place_of(*armature, {*bone, context.interaction->tool == Tool::Move &&
                                        context.transform_settings->part == TransformSettings::Part::Tail});
    if (!view.shows(place)) return std::nullopt;
    return Gizmo{context.interaction->tool, place,
                 axes_of(context.transform_settings->space, *armature, rest_pose(*armature), *bone, view)};
  }
  if (context.workspace() != Workspace::Pose ||
      (context.interaction->tool != Tool::Rotate && context.interaction->tool != Tool::Move))
    return std::nullopt;
  const Pose pose = seen_pose(context);
  const Bone& b = armature->bones[*bone];
  const bool at_head = context.interaction->tool == Tool::Rotate || b.parent < 0;
  const glm::dvec3 place = posed_from_rest(*armature, pose)[*bone] * (at_head ? b.head : b.tail);
  if (!view.shows(place)) return std::nullopt;
  const Space space = context.transform_settings->space;
  const bool rings = context.interaction->tool == Tool::Rotate;
  return Gizmo{context.interaction->tool, place,
               rings ? axes_of_rings(context.posing, space, *armature, pose, *bone, view)
                     : axes_of(space, *armature, pose, *bone, view)};
}

std::optional<Rect> gizmo_rect(const Context& context, const ViewProjection& view) {
  const auto gizmo = gizmo_in(context, view);
  const auto centre = gizmo ? view.pixel_of(gizmo->centre) : std::nullopt;
  if (!centre) return std::nullopt;
  const float reach =
      context.ui->look.px(static_cast<float>(gizmo->tool == Tool::Rotate ? kViewRing : kArrowEnd + kCone));
  return Rect{glm::vec2(*centre) - reach, glm::vec2(*centre) + reach};
}

std::optional<GizmoPart> part_at(const Gizmo& gizmo, const ViewProjection& view, float scale, const glm::dvec2& pixel) {
  const auto centre = view.pixel_of(gizmo.centre);
  if (!centre) return std::nullopt;
  return gizmo.tool == Tool::Rotate ? rotating_part(gizmo, view, scale, pixel, *centre)
                                    : moving_part(gizmo, view, scale, pixel, *centre);
}

bool press_gizmo(Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!place || context.ui->input.down(Key::Alt)) return false;
  const ViewProjection view(context, *place);
  if (const auto pole =
          place->id == ViewId::Body ? pole_at(context, view, glm::dvec2(context.ui->input.pointer)) : std::nullopt) {
    choose_bone(context, *pole);
    begin_tool(context, begin_dragging_pole(context, {.held = MouseButton::Left}));
    return true;
  }
  if (press_joint_handle(context, view)) return true;
  if (context.interaction->tool == Tool::Reach && context.workspace() == Workspace::Pose && context.document().armature)
    return press_joint(context, view);
  const auto gizmo = gizmo_in(context, view);
  const auto part =
      gizmo ? part_at(*gizmo, view, context.ui->look.scale, glm::dvec2(context.ui->input.pointer)) : std::nullopt;
  // The Rig workspace ignores the gizmo's trackball, so that the user can drag joints and bones that lie inside it.
  if (context.workspace() == Workspace::Rig && (!part || part->kind == GizmoPart::Kind::Trackball))
    return press_rig(context, view);
  if (!part) return false;
  const Grip grip{.lock = {part->axis, context.transform_settings->space, part->kind == GizmoPart::Kind::Plane},
                  .held = MouseButton::Left,
                  .trackball = part->kind == GizmoPart::Kind::Trackball};
  if (context.workspace() == Workspace::Rig) {
    const RigChange::Kind kind = gizmo->tool == Tool::Rotate  ? RigChange::Kind::Turn
                                 : gizmo->tool == Tool::Scale ? RigChange::Kind::Scale
                                                              : RigChange::Kind::Move;
    begin_tool(context, begin_rig_change(context, chosen_change(context, kind), grip));
    return true;
  }
  begin_tool(context, gizmo->tool == Tool::Rotate ? begin_turning(context, grip) : begin_dragging(context, grip));
  return true;
}

void choose_bone(Context& context, int bone) {
  *context.selection = {};
  context.selection->bone = bone;
  context.selection->bones = {bone};
}

std::optional<int> bone_at_pointer(const Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!context.document().armature || !place) return std::nullopt;
  if (place->id == ViewId::Body)
    return body_at_pointer(context, *place).pick_bone(glm::ivec2(context.ui->input.pointer - place->rect.low));
  // In a slice, whole bones can be picked only in the Pose workspace. In the Rig workspace, the user picks joints in
  // slices instead (see bone_part_at).
  if (context.workspace() != Workspace::Pose) return std::nullopt;
  const auto below = bones_below(context);
  const auto nearest = std::min_element(below.begin(), below.end());
  return nearest == below.end() ? std::nullopt : std::optional(nearest->second);
}

std::vector<std::pair<double, int>> bones_below(const Context& context) {
  const ViewPlace* place = hovered_view(context);
  std::vector<std::pair<double, int>> found;
  if (!place || !context.views->scene.armature) return found;
  const ViewProjection view(context, *place);
  const glm::dvec2 pixel(context.ui->input.pointer);
  if (place->id == ViewId::Body) {
    for (const render::BoneHit& hit :
         body_at_pointer(context, *place).pick_bones(glm::ivec2(pixel - glm::dvec2(place->rect.low))))
      found.push_back({hit.depth, hit.bone});
    return found;
  }
  for (const DrawnBone& bone : bones_in_slices(context)) {
    const auto head = view.pixel_of(bone.head), tail = view.pixel_of(bone.tail);
    double share = 0;
    if (!head || !tail || distance_to_segment(pixel, *head, *tail, share) > kHit * context.ui->look.scale) continue;
    const glm::dvec3 at = glm::mix(bone.head, bone.tail, share);
    if (view.shows(at)) found.push_back({std::abs(glm::dot(at - view.slice.centre, view.towards_eye)), bone.bone});
  }
  return found;
}

bool pick_bone_part(Context& context) {
  const ViewPlace* place = hovered_view(context);
  const auto part = place
                        ? bone_part_at(context, ViewProjection(context, *place), glm::dvec2(context.ui->input.pointer))
                        : std::nullopt;
  if (!part) return false;
  choose_bone(context, part->bone);
  context.transform_settings->part = part->part;
  return true;
}

void draw_gizmo(Context& context, const ViewPlace& place) {
  const ViewProjection view(context, place);
  draw_rig(context, view);
  draw_bone_labels(context, view);
  draw_rig_check(context, view);
  draw_marks(context, view);
  draw_limits(context, view);
  if (!context.interaction->modal) draw_joint_handles(context, view);
  if (context.interaction->modal) return context.interaction->modal->draw(context, place);
  const auto gizmo = gizmo_in(context, view);
  if (!gizmo) return;
  const GizmoPainter painter(context, view);
  const ViewPlace* under = context.interaction->drag || context.dialogs->shown ? nullptr : hovered_view(context);
  std::optional<GizmoPart> hovered;
  if (under && under->id == place.id)
    hovered = part_at(*gizmo, view, context.ui->look.scale, glm::dvec2(context.ui->input.pointer));
  if (gizmo->tool == Tool::Rotate) draw_rotating(*gizmo, view, context, painter, hovered);
  else draw_moving(*gizmo, view, context, painter, hovered);
}

}  // namespace limber::editor
