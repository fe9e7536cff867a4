// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/clipping_gizmo.h"

#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/layout.h"
#include "editor/context/views.h"
#include "editor/ui/widgets.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr double kThinnest = 1;  // opposite faces of the clip box keep at least this distance, voxels
constexpr double kSnap = 10;     // step to which a dragged handle snaps while Ctrl is held, mm

const Visibility& shown(const Context& context) {
  const auto& preview = context.views->preview_visibility;
  return preview ? *preview : *context.document().visibility;
}

class Painter {
 public:
  Painter(Context& context, const Rect& rect) : context_(context), rect_(rect), size_(rect.size()) {}

  bool pixel_of(const glm::dvec3& world, glm::vec2& pixel) const {
    glm::dvec2 in_view;
    if (!render::project(context_.views->body.camera, world, size_, in_view)) return false;
    pixel = rect_.low + glm::vec2(in_view);
    return true;
  }

  void line(const glm::dvec3& from, const glm::dvec3& to) const {
    glm::vec2 a, b;
    if (pixel_of(from, a) && pixel_of(to, b))
      ImGui::GetWindowDrawList()->AddLine(im(a), im(b), with_alpha(0xFFFFFFFF, 0.6f), context_.ui->look.line());
  }

  // Draws a handle, a square of 9 pixels at scale 1. Returns whether the pointer hovers over it or presses it.
  Pressed handle(const std::string& name, const glm::dvec3& world, Colour colour,
                 const std::string& description) const {
    glm::vec2 at;
    if (!pixel_of(world, at)) return {};
    at = glm::round(at);
    const Look& look = context_.ui->look;
    const float half = std::round(look.px(9) / 2);
    const Pressed pressed = press_area(context_.ui, name, Rect{at - half, at + half}.grown(look.px(3)));
    fill(Rect{at - half, at + half}.grown(1), 0xA0000000);
    fill({at - half, at + half}, pressed.hovered || pressed.held ? 0xFFFFFFFF : colour);
    if (pressed.hovered && !pressed.held) tooltip(context_.ui, {at - half, at + half}, name, description);
    return pressed;
  }

  // Returns the distance that the dragged handle has moved since it was pressed, as a multiple of the vector
  // `direction`.
  double dragged(const glm::dvec3& world, const glm::dvec3& direction) const {
    return along(context_.views->body.camera, size_, world, direction,
                 glm::dvec2(context_.ui->input.pointer - context_.views->handle_from));
  }

 private:
  Context& context_;
  const Rect rect_;
  glm::ivec2 size_;
};

void begin_preview(Context& context) {
  context.views->preview_visibility = context.document().visibility;
  context.views->handle_from = context.ui->input.pointer;
}

// Stores the previewed clip box and clip plane in the document, as an edit named `label`.
void end_preview(Context& context, const std::string& label) {
  const auto preview = context.views->preview_visibility;
  context.views->preview_visibility.reset();
  if (!preview || *preview == *context.document().visibility) return;
  Document next = context.document();
  next.visibility = preview;
  commit(context, label, std::move(next));
}

void commit_clip(Context& context, const std::string& label, Visibility visibility) {
  context.views->preview_visibility = std::make_shared<const Visibility>(std::move(visibility));
  end_preview(context, label);
}

double snapped(double millimetres) { return std::round(millimetres / kSnap) * kSnap; }

void draw_box(Context& context, const Painter& painter) {
  const auto volume = context.document().volume;
  const Grid& grid = volume->grid;
  const AffineTransform world = world_from_voxel(grid);
  const ClipBox box = shown(context).clip_box;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      if (corner >> axis & 1) continue;
      glm::dvec3 from, to;
      for (int k = 0; k < 3; ++k) from[k] = to[k] = corner >> k & 1 ? box.high[k] : box.low[k];
      to[axis] = box.high[axis];
      painter.line(world * from, world * to);
    }

  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const auto face_centre = [&](const ClipBox& b) {
        glm::dvec3 p = (b.low + b.high) * 0.5;
        p[axis] = high ? b.high[axis] : b.low[axis];
        return world * p;
      };
      const glm::dvec3 normal(grid.direction[axis]), size = glm::abs(normal);
      const int world_axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
      const std::string name = std::string("Clip face ") + "xyz"[axis] + (high ? "+" : "-");
      const Pressed pressed = painter.handle(name, face_centre(box), context.ui->look.theme.axis[world_axis],
                                             "Drag to move this face of the clip box; hold Ctrl to snap to 10 mm. "
                                             "Double-click to move it back to the volume's border.");
      if (pressed.double_clicked) {
        Visibility next = *context.document().visibility;
        move_face(next.clip_box, grid, axis, high, high ? grid.size[axis] - 0.5 : -0.5);
        commit_clip(context, "Reset clip face", std::move(next));
        continue;
      }
      if (pressed.activated) begin_preview(context);
      if (pressed.held && context.views->preview_visibility) {
        Visibility next = *context.document().visibility;
        const ClipBox& start = context.document().visibility->clip_box;
        double place =
            (high ? start.high : start.low)[axis] + std::round(painter.dragged(face_centre(start), world.linear[axis]));
        if (context.ui->input.modifiers().ctrl) {
          // Snaps the face to a multiple of 10 mm on the world axis that is nearest to the face's normal.
          const double step = world.linear[axis][world_axis],
                       first = face_centre(start)[world_axis] - step * (high ? start.high : start.low)[axis];
          place = (snapped(first + step * place) - first) / step;
        }
        move_face(next.clip_box, grid, axis, high, place);
        context.views->preview_visibility = std::make_shared<const Visibility>(std::move(next));
        context.ui->touch();
      }
      if (ImGui::IsItemDeactivated()) end_preview(context, "Move clip box");
    }
}

void draw_plane(Context& context, const Painter& painter) {
  const ClipPlane plane = shown(context).clip_plane;
  const glm::dvec3 normal = plane.normal;
  const glm::dvec3 other = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(other, normal)), up = glm::cross(normal, right);
  const double half = context.views->body.camera.distance * 0.09;
  const glm::dvec3 corners[] = {plane.point + half * (right + up), plane.point + half * (up - right),
                                plane.point - half * (right + up), plane.point + half * (right - up)};
  for (int i = 0; i < 4; ++i) painter.line(corners[i], corners[(i + 1) % 4]);
  painter.line(plane.point, plane.point + half * normal);
  const Pressed pressed = painter.handle(
      "Clip plane", plane.point + half * normal, kViewAccent,
      "Drag to move the clip plane along its normal; hold Ctrl for steps of 10 mm. Double-click to move it to the "
      "cross-hair.");
  if (pressed.double_clicked) {
    Visibility next = *context.document().visibility;
    next.clip_plane.point = context.views->cross_hair;
    return commit_clip(context, "Reset clip plane", std::move(next));
  }
  if (pressed.activated) begin_preview(context);
  if (pressed.held && context.views->preview_visibility) {
    Visibility next = *context.document().visibility;
    const double by = painter.dragged(next.clip_plane.point + half * normal, normal);
    next.clip_plane.point += normal * (context.ui->input.modifiers().ctrl ? snapped(by) : by);
    context.views->preview_visibility = std::make_shared<const Visibility>(std::move(next));
    context.ui->touch();
  }
  if (ImGui::IsItemDeactivated()) end_preview(context, "Move clip plane");
}

}  // namespace

void move_face(ClipBox& box, const Grid& grid, int axis, bool high, double voxel) {
  if (high)
    box.high[axis] =
        std::clamp(voxel, box.low[axis] + kThinnest, std::max(grid.size[axis] - 0.5, box.low[axis] + kThinnest));
  else box.low[axis] = std::clamp(voxel, std::min(-0.5, box.high[axis] - kThinnest), box.high[axis] - kThinnest);
}

double along(const render::Camera& camera, const glm::ivec2& size, const glm::dvec3& point, const glm::dvec3& direction,
             const glm::dvec2& pixels) {
  glm::dvec2 from, to;
  // Measures the length of the direction vector on the screen, in pixels. Only a short part of the vector is projected,
  // because in perspective the number of pixels per mm varies along the vector.
  const double step = camera.distance * 1e-3 / std::max(glm::length(direction), 1e-12);
  if (!render::project(camera, point, size, from) || !render::project(camera, point + direction * step, size, to))
    return 0;
  const glm::dvec2 seen = (to - from) / step;
  const double squared = glm::dot(seen, seen);
  return squared < 1e-6 ? 0 : glm::dot(pixels, seen) / squared;
}

void draw_clip_handles(Context& context, const Rect& rect) {
  const auto visibility = context.document().visibility;  // copied, since releasing a handle changes the document
  if (!context.document().volume || !visibility) return;
  const Painter painter(context, rect);
  if (visibility->clip_box.enabled) draw_box(context, painter);
  if (visibility->clip_plane.enabled) draw_plane(context, painter);
}

}  // namespace limber::editor
