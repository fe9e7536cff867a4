// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/measure/measure_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <imgui.h>

#include "core/base/error.h"
#include "core/measure/body_girth.h"
#include "core/measure/tissue_thickness.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/pointer_context.h"
#include "editor/context/view_projection.h"
#include "editor/input/keymap.h"
#include "editor/measure/measure_overlay.h"
#include "editor/measure/measure_view.h"
#include "editor/shown/compare_wipe.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/messages.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

// A point of the body under the pointer.
struct PointOnBody {
  ViewPlace place;
  glm::dvec3 at_rest, shown;  // positions of the point in the rest pose and in the shown pose, world, mm
  glm::ivec3 voxel;           // voxel of the volume at rest that contains the point
};

// Returns the point of the body under the pointer, in any view; nothing if there is none. In a slice, the point may
// lie in air, up to two voxels from tissue, or anywhere in the grey image that the slice shows.
std::optional<PointOnBody> point_under_pointer(Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!place || !context.document().volume) return std::nullopt;
  const render::Scene& scene = scene_at_pointer(context, *place);
  const glm::vec2 pixel = context.ui->input.pointer - place->rect.low;
  std::optional<render::Hit> hit;
  std::optional<glm::dvec3> shown;
  if (place->id == ViewId::Body) {
    if (hit = pick_body(context, *place, glm::ivec2(pixel)); hit) shown = hit->point;
  } else {
    shown = world_of(slice_of(*context.views, place->id).camera, pixel, place->rect.size());
  }
  if (!shown || !scene.volume) return std::nullopt;
  const bool is_result = scene.volume != context.document().volume;
  const auto at_rest = is_result ? std::nullopt : point_at_rest(scene, *shown);
  if (!at_rest) return std::nullopt;
  const bool on_image = place->id != ViewId::Body && scene.grey && image_value_at(*scene.grey->image, *at_rest);
  if (!on_image && !is_at_tissue(*context.document().volume, *at_rest)) return std::nullopt;
  // In the 3D view, the point lies on the surface between body and air, so the voxel that was hit is used. In a slice,
  // the nearest voxel is used.
  const glm::ivec3 nearest(glm::floor(voxel_from_world(scene.volume->grid) * *at_rest + 0.5));
  return PointOnBody{*place, *at_rest, *shown, hit ? hit->voxel : nearest};
}

// Runs the operator that is bound to a chord, if the operator only changes the view. Returns true if it ran. So the
// user can turn the body and move slices between two clicks of the tool.
bool navigate(Context& context, const Chord& chord) {
  constexpr const char* kNavigation[] = {"view.orbit", "view.pan",    "view.zoom",  "view.front",    "view.back",
                                         "view.left",  "view.right",  "view.top",   "view.bottom",   "view.opposite",
                                         "view.ortho", "view.frame_", "slice.next", "slice.previous"};
  if (!hovered_view(context)) return false;
  const std::string* id = context.keymap->find(chord, contexts(context));
  if (!id || std::none_of(std::begin(kNavigation), std::end(kNavigation),
                          [&](const char* name) { return id->starts_with(name); }))
    return false;
  run(context, *id);
  return true;
}

// Returns true if a dialog, an error message, a text field or a popup is open. It then gets the input instead of the
// tool.
bool is_busy(const Context& context) {
  return context.dialogs->shown || !context.messages->errors.empty() || is_typing(context.ui) ||
         ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

// Returns the direction of the bone nearest to a point of the body at rest; no value without a rig.
std::optional<glm::dvec3> along_nearest_bone(const Document& document, const glm::dvec3& point) {
  if (!document.armature) return std::nullopt;
  double least = std::numeric_limits<double>::max();
  std::optional<glm::dvec3> along;
  for (const Bone& bone : document.armature->bones) {
    const glm::dvec3 way = bone.tail - bone.head;
    if (const double d = distance_to_bone(bone, point); d < least && glm::length(way) > 0)
      least = d, along = glm::normalize(way);
  }
  return along;
}

class MeasureTool final : public Modal {
 public:
  MeasureTool(const Context& context, MeasureKind kind) : kind_(kind), volume_(context.document().volume) {}

  bool moved(Context& context, const glm::vec2& pixels) override {
    if (context.interaction->drag && context.interaction->drag->moved)
      context.interaction->drag->moved(context, pixels);
    context.ui->touch();
    return true;
  }
  bool wheel(Context& context, float steps) override {
    context.ui->input.wheel = steps;
    navigate(context, {Chord::Kind::Wheel, context.ui->input.modifiers()});
    return true;
  }
  void cancel(Context& context) override { end_drag(context); }
  // Ends the tool if a menu, dialog or text field opens, or if the volume changes. The menu from which the tool was
  // started may be open in the tool's first frames; it does not end the tool.
  bool frame(Context& context, double) override {
    if (!is_busy(context)) was_free_ = true;
    if (!(was_free_ && is_busy(context)) && context.document().volume == volume_) return true;
    end_drag(context);
    return false;
  }
  bool button(Context& context, const ButtonChanged& event) override {
    if (event.button == MouseButton::Middle) {
      end_drag(context);
      if (!event.down || is_busy(context)) return true;
      const Modifiers modifiers = context.ui->input.modifiers();
      if (!navigate(context, {Chord::Kind::Drag, modifiers, Key::None, event.button}))
        navigate(context, {Chord::Kind::Press, modifiers, Key::None, event.button});
      return true;
    }
    if (context.interaction->drag) return true;
    if (event.button == MouseButton::Right && event.down) return false;
    const ViewPlace* place = hovered_view(context);
    if (event.button != MouseButton::Left || !event.down || !place || over_widget(context.ui)) return true;
    const auto point = point_under_pointer(context);
    const bool needs_tissue = kind_ == MeasureKind::Girth || kind_ == MeasureKind::Thickness;
    const auto& tissues = context.document().tissues;
    if (point && needs_tissue && (!tissues || tissues->tissues.empty())) {
      context.messages->info("A girth or a thickness needs labels",
                             "Edit > Prepare volume makes labels from the image. Distances and angles need none.");
      return true;
    }
    if (!point || (needs_tissue && context.document().volume->at_or_air(point->voxel) == 0)) {
      const bool is_result = scene_at_pointer(context, *place).volume != context.document().volume;
      context.messages->info("The pointer is not on the body",
                             is_result
                                 ? "Points cannot be set on a result. Set them on the body at rest or in the pose."
                                 : "Click on the body, in 3D or in a slice.");
      return true;
    }
    try {
      take(context, *point);
    } catch (const Error& error) {
      const ErrorMessage message = parts_of(error.what());
      context.messages->warn(message.what, message.what_to_do);
    }
    context.ui->touch();
    return true;
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (!event.down) return true;
    context.ui->touch();
    if (event.key == Key::Backspace) {
      if (!points_.empty()) points_.pop_back();
      return true;
    }
    const Chord chord{Chord::Kind::Key, context.ui->input.modifiers(), event.key};
    if (navigate(context, chord)) return true;
    const std::string* id = context.keymap->find(chord, {"global"});
    if (id && points_.empty() && (*id == "edit.undo" || *id == "edit.redo")) {
      run(context, *id);
      return true;
    }
    if (event.key != Key::Escape && event.key != Key::Return && event.key != Key::NumEnter) return true;
    end_drag(context);
    return false;
  }

  void draw(Context& context, const ViewPlace& place) override {
    if (points_.empty()) return;
    const render::Scene& scene = scene_of(context, place);
    if (scene.volume != context.document().volume) return;
    const ViewProjection view(context, place);
    std::vector<glm::dvec3> points = points_on_scene(context, scene, points_);
    std::vector<std::string> words;
    if (const auto pointer = point_under_pointer(context)) {
      points.push_back(pointer->shown);
      if (is_complete(kind_, points.size())) words.push_back(text_of_measure(kind_, measure(kind_, points)));
    }
    std::vector<Rect> taken;
    draw_measure_lines(context, view, kind_, points, true);
    draw_measure_label(context.ui, view, kind_, points, words, true, taken);
  }

  std::vector<KeyHint> hints(const Context&) const override {
    const char* click = kind_ == MeasureKind::Girth       ? "Measure the girth"
                        : kind_ == MeasureKind::Thickness ? "Measure the tissue"
                                                          : "Set a point";
    std::vector<KeyHint> all{{{"LMB"}, click}};
    if (!points_.empty()) all.push_back({{"Backspace"}, "Remove the last point"});
    all.push_back({{"MMB"}, "Turn the view"});
    all.push_back({{"Enter", "Esc"}, "Done"});
    return all;
  }
  std::string title() const override { return "Measure " + std::string(word_of(kind_)); }

 private:
  // Ends a running drag that turns or shifts a view.
  static void end_drag(Context& context) {
    if (!context.interaction->drag) return;
    const Drag ended = std::move(*context.interaction->drag);
    context.interaction->drag.reset();
    if (ended.ended) ended.ended(context);
  }
  void take(Context& context, const PointOnBody& point) {
    const LabelVolume& volume = *context.document().volume;
    if (kind_ == MeasureKind::Girth) {
      add_measurement(context, kind_, girth_tape(volume, point.at_rest, normal_at(context, point)));
    } else if (kind_ == MeasureKind::Thickness) {
      const auto ends = thickness_line(volume, point.voxel);
      add_measurement(context, kind_, {ends[0], ends[1]});
    } else {
      points_.push_back(point.at_rest);
      if (is_complete(kind_, points_.size())) add_measurement(context, kind_, std::exchange(points_, {}));
    }
  }
  // Returns the normal of the plane in which a girth is measured. If the user clicked a slice of the body at rest,
  // this is the slice's normal. Otherwise it is the direction of the nearest bone, or without a rig the normal with
  // the smallest girth.
  static glm::dvec3 normal_at(const Context& context, const PointOnBody& point) {
    const bool is_posed = scene_of(context, point.place).pose != nullptr;
    if (point.place.id != ViewId::Body && !is_posed) return render::frame_of(axis_of(point.place.id)).normal;
    if (const auto along = along_nearest_bone(context.document(), point.at_rest)) return *along;
    const ViewProjection view(context, point.place);
    const glm::dvec3 inward = view.ray(glm::dvec2(context.ui->input.pointer)).direction;
    const LabelVolume& volume = *context.document().volume;
    return least_girth_normal(volume, middle_along(volume, point.at_rest, inward));
  }

  MeasureKind kind_;
  std::shared_ptr<const LabelVolume> volume_;
  bool was_free_ = false;           // true once a frame had no open menu, dialog or text field
  std::vector<glm::dvec3> points_;  // points set so far, in the rest pose, world, mm
};

}  // namespace

std::unique_ptr<Modal> begin_measuring(const Context& context, MeasureKind kind) {
  return std::make_unique<MeasureTool>(context, kind);
}

bool is_measuring(const Context& context) {
  return dynamic_cast<const MeasureTool*>(context.interaction->modal.get()) != nullptr;
}

}  // namespace limber::editor
