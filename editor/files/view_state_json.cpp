// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/view_state_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "editor/context/context.h"
#include "editor/context/layout_json.h"
#include "editor/context/open_project.h"
#include "editor/context/resampling_settings.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/motion/constrained_pose.h"
#include "editor/shown/shown_pose.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

using Json = nlohmann::json;

namespace {

constexpr const char* kSchema = "limber-editor/1";
constexpr double kFarthest = 1e6;  // a stored camera distance or coordinate beyond this is ignored, mm

template <class Vector>
Json json_of(const Vector& v) {
  Json json = Json::array();
  for (int i = 0; i < v.length(); ++i) json.push_back(v[i]);
  return json;
}

void take(const Json& json, const char* key, bool& value) {
  if (const auto found = json.find(key); found != json.end() && found->is_boolean()) value = *found;
}

template <class Number>
void take(const Json& json, const char* key, double low, double high, Number& value) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return;
  const double number = *found;
  if (number >= low && number <= high) value = static_cast<Number>(number);
}

// Reads an enum value that is stored as a number. A number outside [0, count) leaves `value` unchanged.
template <class Choice>
void take_choice(const Json& json, const char* key, int count, Choice& value) {
  int number = -1;
  take(json, key, 0, count - 1, number);
  if (number >= 0) value = static_cast<Choice>(number);
}

template <class Vector>
bool take_vector(const Json& json, const char* key, Vector& value) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || std::ssize(*found) != Vector::length()) return false;
  Vector read = value;
  for (int i = 0; i < Vector::length(); ++i) {
    if (!(*found)[i].is_number() || !(std::abs((*found)[i].template get<double>()) <= kFarthest)) return false;
    read[i] = (*found)[i].template get<typename Vector::value_type>();
  }
  value = read;
  return true;
}

Json json_of(const render::Camera& camera) {
  const glm::dquat& q = camera.world_from_view;
  return {{"centre", json_of(camera.centre)},
          {"distance", camera.distance},
          {"world_from_view", {q.w, q.x, q.y, q.z}},
          {"projection", static_cast<int>(camera.projection)}};
}

void restore(const Json& json, render::Camera& camera) {
  glm::dvec4 turn(0);
  glm::dvec3 centre = camera.centre;
  if (!take_vector(json, "world_from_view", turn) || !take_vector(json, "centre", centre) ||
      std::abs(glm::length(turn) - 1) > 1e-3)
    return;
  camera.centre = centre;
  camera.world_from_view = glm::normalize(glm::dquat(turn[0], turn[1], turn[2], turn[3]));
  take(json, "distance", 1e-2, kFarthest, camera.distance);
  take_choice(json, "projection", 2, camera.projection);
}

// Starts to read the image with which the project was saved. If its file is gone, looks beside the project's file.
void restore_image(Context& context, const Json& json) {
  const Json path = json.value("path", Json());
  if (!path.is_string() || path.get<std::string>().empty()) return;
  render::ShownGrey shown;
  take(json, "level", -1e9, 1e9, shown.level);
  take(json, "width", 1e-9, 1e9, shown.width);
  take(json, "tissues", 0, 1, shown.tissues);
  take_choice(json, "rendering", 5, shown.rendering);
  Path file = path.get<std::string>();
  std::error_code error;
  if (const Path beside = context.project->path.parent_path() / file.filename();
      !std::filesystem::exists(file, error) && std::filesystem::exists(beside, error))
    file = beside;
  reopen_image(context, file, json.contains("level") ? std::optional(shown) : std::nullopt);
}

// Stores the free pose (the pose before constraints are applied) if the user made it by hand. The document contains
// only the pose after the constraints.
void add_free_pose(Json& json, const Context& context) {
  const auto free = free_pose_by_hand(context);
  if (!free) return;
  Json& stored = json["free_pose"] = {{"root", json_of(free->root_translation)}, {"rotations", Json::array()}};
  for (const glm::dquat& q : free->rotation) stored["rotations"].push_back(Json::array({q.w, q.x, q.y, q.z}));
}

void restore_free_pose(Context& context, const Json& json) {
  const Document& document = context.document();
  const auto stored = json.find("free_pose");
  if (!is_constrained(document) || stored == json.end() || !stored->is_object()) return;
  Pose free = rest_pose(*document.armature);
  const auto rotations = stored->find("rotations");
  if (rotations == stored->end() || !rotations->is_array() || rotations->size() != free.rotation.size()) return;
  if (!take_vector(*stored, "root", free.root_translation)) return;
  for (std::size_t bone = 0; bone < free.rotation.size(); ++bone) {
    glm::dvec4 q(0);
    if (!take_vector(Json{{"q", (*rotations)[bone]}}, "q", q) || std::abs(glm::length(q) - 1) > 1e-6) return;
    free.rotation[bone] = glm::dquat(q[0], q[1], q[2], q[3]);
  }
  remember_free_pose(context.timeline, document, pose_of(document), free);
}

}  // namespace

std::string editor_state(const Context& context) {
  const Views& views = *context.views;
  Json json{{"schema", kSchema},
            {"workspace", static_cast<int>(context.workspace())},
            {"display", static_cast<int>(views.display)},
            {"slices", static_cast<int>(views.slice_display)},
            {"cross_hair", json_of(views.cross_hair)},
            {"camera", json_of(views.body.camera)},
            {"grid", views.grid},
            {"axes", views.axes},
            {"scale_bar", views.scale_bar},
            {"rulers", views.rulers},
            {"letters", views.letters},
            {"show_cross_hair", views.show_cross_hair},
            {"bones", views.bones},
            {"bone_shape", static_cast<int>(views.bone_shape)},
            {"bone_names", views.bone_names},
            {"bone_axes", views.bone_axes},
            {"bones_in_front", views.bones_in_front}};
  json["weights"] = {{"display", context.skin->display ? static_cast<int>(*context.skin->display) : 4},
                     {"contours", context.skin->contours}};
  json["arrangements"] = Json::parse(json_text(context.screen->arrangements));
  json["method"] = context.resampling->method;
  json["finite_elements"] = {{"quality", context.resampling->quality}, {"contact", context.resampling->contact}};
  for (const SliceState& slice : views.slices)
    json["slice_cameras"].push_back(
        {{"centre", json_of(slice.camera.centre)}, {"millimetres_per_pixel", slice.camera.millimetres_per_pixel}});
  if (views.image)
    json["image"] = {{"path", views.image_path.string()},
                     {"level", views.image->level},
                     {"width", views.image->width},
                     {"tissues", views.image->tissues},
                     {"rendering", static_cast<int>(views.image->rendering)}};
  // The image's file was not found, but its path is kept.
  else if (!views.image_path.empty()) json["image"] = {{"path", views.image_path.string()}};
  add_free_pose(json, context);
  if (context.selection->tissue) json["tissue"] = *context.selection->tissue;
  // The path may contain bytes that are not valid UTF-8. They are replaced, so that the state is stored in any case.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void restore_editor_state(Context& context, const std::string& text) {
  const Json json = Json::parse(checked_json(text, "the state of the editor in the project"), nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != kSchema) return;
  Views& views = *context.views;
  take_choice(json, "workspace", 4, context.screen->workspace);
  take_choice(json, "display", 4, views.display);
  if (const auto image = json.find("image"); image != json.end() && image->is_object()) restore_image(context, *image);
  take_choice(json, "slices", 2, views.slice_display);
  if (const Json method = json.value("method", Json()); method.is_string() && find_method(method.get<std::string>()))
    context.resampling->method = method;
  if (const auto fem = json.find("finite_elements"); fem != json.end() && fem->is_object()) {
    if (const Json quality = fem->value("quality", Json());
        quality == "draft" || quality == "normal" || quality == "fine")
      context.resampling->quality = quality;
    take(*fem, "contact", context.resampling->contact);
  }
  if (const auto weights = json.find("weights"); weights != json.end() && weights->is_object()) {
    int display = context.skin->display ? static_cast<int>(*context.skin->display) : 4;
    take(*weights, "display", 0, 4, display);
    context.skin->display = display == 4 ? std::nullopt : std::optional(static_cast<render::WeightDisplay>(display));
    take(*weights, "contours", context.skin->contours);
  }
  take_vector(json, "cross_hair", views.cross_hair);
  take(json, "grid", views.grid);
  take(json, "axes", views.axes);
  take(json, "scale_bar", views.scale_bar);
  take(json, "rulers", views.rulers);
  take(json, "letters", views.letters);
  take(json, "show_cross_hair", views.show_cross_hair);
  take(json, "bones", views.bones);
  take_choice(json, "bone_shape", 3, views.bone_shape);
  take(json, "bone_names", views.bone_names);
  take(json, "bone_axes", views.bone_axes);
  take(json, "bones_in_front", views.bones_in_front);
  if (const auto camera = json.find("camera"); camera != json.end() && camera->is_object())
    restore(*camera, views.body.camera);
  views.body.name.clear();
  if (json.contains("arrangements")) restore(json["arrangements"].dump(), context.screen->arrangements);
  if (const auto all = json.find("slice_cameras"); all != json.end() && all->is_array())
    for (std::size_t i = 0; i < std::min(all->size(), views.slices.size()); ++i) {
      if (!(*all)[i].is_object()) continue;
      take_vector((*all)[i], "centre", views.slices[i].camera.centre);
      take((*all)[i], "millimetres_per_pixel", 1e-6, 1e4, views.slices[i].camera.millimetres_per_pixel);
    }
  restore_free_pose(context, json);
  int tissue = -1;
  take(json, "tissue", 0, 65535, tissue);
  if (tissue >= 0 && context.document().tissues && context.document().tissues->find(static_cast<Label>(tissue))) {
    context.selection->tissue = static_cast<Label>(tissue);
    context.selection->tissues = {static_cast<Label>(tissue)};
  }
  context.ui->touch();
}

}  // namespace limber::editor
