// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/views.h"
#include "editor/pose/pose_library.h"
#include "editor/ui/ui.h"

#include <algorithm>

#include "core/base/error.h"
#include "editor/context/document_edits.h"
#include "editor/context/transform_settings.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/motion/timeline.h"
#include "editor/pose/body_pose_cards.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_tools.h"
#include "editor/ui/icons.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

std::string needs_rig(const Context& context) { return context.document().armature ? "" : "Import a rig first"; }
std::string needs_chosen(const Context& context) {
  if (const std::string why = needs_rig(context); !why.empty()) return why;
  return chosen_pose(context)               ? ""
         : context.document().poses.empty() ? "Add a pose to the library first"
                                            : "Select a pose in the pose library first";
}
// Returns why the selected pose cannot be renamed or deleted, such as that the pose is built in; "" when it can.
std::string needs_own(const Context& context) {
  if (const std::string why = needs_chosen(context); !why.empty()) return why;
  return is_body_pose(context.transform_settings->library_pose) ? "This pose is built in and cannot be changed" : "";
}

std::size_t place_of(const PoseLibrary& library, const std::string& name) {
  return static_cast<std::size_t>(
      std::find_if(library.begin(), library.end(), [&](const auto& pose) { return pose->name == name; }) -
      library.begin());
}

// Returns a PNG picture of the shown pose as seen in the 3D view; "" without a volume. The picture shows the body. When
// the body does not follow the pose, the picture also shows the bones.
std::string picture_of_pose(Context& context) {
  Views& views = *context.views;
  if (!context.document().volume) return "";
  render::Scene scene = views.scene;
  scene.grid = false;
  scene.dark_background = true;
  scene.outlined.reset();
  scene.bones.clear();
  if (scene.pose || !context.document().pose) scene.armature.reset();
  render::View3D picture(views.renderer);
  for (double now = 0; now == 0 || !picture.complete(); now += 1)
    picture.draw(scene, views.body.camera, kThumbnailSize, now, 1);
  return render::png_of(picture.read());
}

void add_pose(Context& context) {
  settle_frame(context);
  Document next = context.document();
  const Clip* clip = next.shown_clip();
  NamedPose named =
      named_pose(next.poses, clip && clip->motion ? clip->name + " " + std::to_string(next.frame) : "Pose",
                 *next.armature, pose_of(next), chosen_bones(context));
  named.picture = picture_of_pose(context);
  context.transform_settings->library_pose = named.name;
  context.ui->open_sections["Pose library"] = true;
  const std::string label = "Add pose " + named.name;
  next.poses.push_back(std::make_shared<const NamedPose>(std::move(named)));
  commit(context, label, std::move(next));
}

void blend_to_chosen(Context& context) {
  const NamedPose named = *chosen_pose(context);
  begin_tool(context, begin_blending(context, {.label = "Blend to " + named.name,
                                               .words = "of the way to " + named.name,
                                               .from = pose_of(context.document()),
                                               .to = on_the_way_to(context, named, 1)}));
}

void ask_pose_name(Context& context) {
  const std::string before = context.transform_settings->library_pose;
  context.dialogs->open(make_form({"Rename pose",
                                   "Changes the name of the selected pose of the library.",
                                   "Rename",
                                   {text_of("Name", "The pose's name.", before)},
                                   [](const Context&, const std::vector<FormField>& fields) -> std::string {
                                     if (fields[0].text.empty())
                                       throw Error("a pose needs a name", "rename", "type a name");
                                     return "";
                                   },
                                   [before](Context& c, const std::vector<FormField>& fields) {
                                     Document next = c.document();
                                     const std::size_t place = place_of(next.poses, before);
                                     if (place == next.poses.size() || fields[0].text == before) return;
                                     NamedPose named = *next.poses[place];
                                     named.name = unique_pose_name(next.poses, fields[0].text);
                                     c.transform_settings->library_pose = named.name;
                                     next.poses[place] = std::make_shared<const NamedPose>(std::move(named));
                                     commit(c, "Rename pose", std::move(next));
                                   }}));
}

void delete_pose(Context& context) {
  Document next = context.document();
  const std::string name = context.transform_settings->library_pose;
  next.poses.erase(next.poses.begin() + static_cast<std::ptrdiff_t>(place_of(next.poses, name)));
  commit(context, "Delete pose " + name, std::move(next));
}

}  // namespace

const NamedPose* chosen_pose(const Context& context) {
  if (is_body_pose(context.transform_settings->library_pose)) {
    const PoseLibrary& cards = body_pose_cards(context);
    const auto found = std::find_if(cards.begin(), cards.end(), [&](const auto& pose) {
      return library_name(*pose) == context.transform_settings->library_pose;
    });
    return found == cards.end() ? nullptr : found->get();
  }
  const PoseLibrary& library = context.document().poses;
  const std::size_t place = place_of(library, context.transform_settings->library_pose);
  return place < library.size() ? library[place].get() : nullptr;
}

Pose on_the_way_to(const Context& context, const NamedPose& named, double share) {
  const std::vector<int> bones = chosen_bones(context);
  const Armature& armature = *context.document().armature;
  const Pose from = pose_of(context.document()), to = taken_from(named, armature, from, bones);
  if (share <= 0 || share >= 1) return limited(context, share <= 0 ? from : to, bones);
  Pose pose = from;
  for (const int bone : bones)
    pose.rotation[bone] = glm::normalize(glm::slerp(from.rotation[bone], to.rotation[bone], share));
  pose.root_translation = glm::mix(from.root_translation, to.root_translation, share);
  return limited(context, std::move(pose), bones);
}

std::vector<int> set_on_the_way(const Context& context, double share) {
  return share >= 1 ? chosen_bones(context) : std::vector<int>{};
}

void apply_pose(Context& context, const NamedPose& named, double share) {
  settle_frame(context);
  commit_pose(context, (share < 1 ? "Blend to " : "Apply ") + named.name, on_the_way_to(context, named, share),
              set_on_the_way(context, share));
}

std::vector<Operator> pose_library_operators() {
  return {
      {"pose.library_add", "Add to library", icon::kAdd, "Pose",
       "Add the pose of the selected bones, or of all, to the pose library.", add_pose, needs_rig},
      {"pose.library_apply", "Apply library pose", "", "Pose",
       "Apply the selected pose of the library to the selected bones, or to all.",
       [](Context& c) {
         const NamedPose named = *chosen_pose(c);
         apply_pose(c, named, 1);
       },
       needs_chosen},
      {"pose.library_blend", "Blend to library pose", "", "Pose",
       "Blend the selected bones towards the selected pose of the library, with the pointer or by percent.",
       blend_to_chosen, needs_chosen},
      {"pose.library_rename", "Rename pose...", icon::kRename, "Pose", "Rename the selected pose of the library.",
       ask_pose_name, needs_own},
      {"pose.library_delete", "Delete pose", icon::kTrash, "Pose", "Delete the selected pose from the library.",
       delete_pose, needs_own},
  };
}

}  // namespace limber::editor
