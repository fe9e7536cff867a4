// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/study_pictures.h"

#include <cmath>

#include "render/gl/egl_context.h"
#include "render/image_io.h"
#include "render/scene/tissue_appearance.h"
#include "render/view.h"

namespace limber::editor {

namespace {
using namespace render;

struct Studio {
  HeadlessContext context;
  Renderer renderer;
};

Camera camera_of(const PictureFrame& frame) {
  Camera camera{.centre = frame.centre, .projection = Projection::Orthographic};
  camera.world_from_view = glm::normalize(glm::quat_cast(glm::dmat3(frame.right, frame.up, frame.towards_eye())));
  camera.distance = frame.height_mm / 2 / std::tan(camera.field_of_view / 2);
  return camera;
}

std::string draw(Studio& studio, const BodyPicture& body) {
  Scene scene{.volume = body.volume,
              .looks = std::make_shared<const LabelLooks>(looks_of(*body.tissues)),
              .bone_shape = BoneShape::None,
              .grid = false};
  if (body.cut) scene.clip.plane = {body.frame.centre, body.frame.towards_eye()};
  View3D view(studio.renderer);
  for (double now = 0; now == 0 || !view.complete(); now += 1)
    view.draw(scene, camera_of(body.frame), body.frame.size, now);
  return png_of(view.read());
}
}  // namespace

PictureMaker start_pictures() {
  return [studio = std::make_shared<Studio>()](const BodyPicture& body) { return draw(*studio, body); };
}

}  // namespace limber::editor
