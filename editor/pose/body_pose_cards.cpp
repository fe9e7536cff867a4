// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/body_pose_cards.h"

#include "core/pose/body_poses.h"
#include "core/project/document.h"
#include "editor/context/context.h"
#include "editor/context/transform_settings.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/volume/body_picture.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

constexpr char kMark = '\x01';  // prefix of built-in poses' names; no user can type this character

void draw_pictures(const std::shared_ptr<const Armature>& armature, PoseLibrary& poses) {
  std::vector<int> bones(armature->bones.size());
  for (std::size_t b = 0; b < bones.size(); ++b) bones[b] = static_cast<int>(b);
  for (auto& pose : poses) {
    NamedPose drawn = *pose;
    drawn.picture = render::png_of(
        body_picture(*armature, taken_from(drawn, *armature, rest_pose(*armature), bones), kThumbnailSize));
    pose = std::make_shared<const NamedPose>(std::move(drawn));
  }
}

}  // namespace

const PoseLibrary& body_pose_cards(const Context& context) {
  auto& known = context.transform_settings->body_poses;
  const std::shared_ptr<const Armature>& armature = context.document().armature;
  if (known.armature != armature) known = {armature, armature ? body_pose_library(*armature) : PoseLibrary{}};
  return known.poses;
}

const PoseLibrary& pictured_body_pose_cards(const Context& context) {
  body_pose_cards(context);
  auto& known = context.transform_settings->body_poses;
  if (!known.poses.empty() && known.poses.front()->picture.empty()) draw_pictures(known.armature, known.poses);
  return known.poses;
}

std::string library_name(const NamedPose& body_pose) { return kMark + body_pose.name; }

bool is_body_pose(const std::string& library_name) { return library_name.starts_with(kMark); }

}  // namespace limber::editor
