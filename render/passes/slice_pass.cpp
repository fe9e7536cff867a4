// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/slice_pass.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <epoxy/gl.h>

#include "render/passes/view_rays.h"

namespace limber::render {

SlicePass::SlicePass() : nothing_(gl::VertexArray::create()) {}

void SlicePass::draw(const VolumeTexture& volume, const PosedTexture* posed, const LooksTexture& looks,
                     const WeightTexture* weights, bool contours, const GreyTexture* grey, const ShownGrey& shown_grey,
                     const SliceCamera& camera, SliceDisplay display, std::optional<Label> outlined, float line_scale,
                     const glm::ivec2& size) {
  auto& program = programs_[{volume.layout().atlases, posed != nullptr, grey != nullptr,
                             weights ? std::optional(weights->reading()) : std::nullopt}];
  if (!program) {
    const int atlases = volume.layout().atlases;
    const std::string reads =
        weights ? weight_defines(atlases, weights->reading()) + gl::define("WEIGHTS") : atlas_defines(atlases);
    program = std::make_unique<gl::Program>(
        gl::kWholePicture, "slice.frag", reads + (posed ? gl::define("POSED") : "") + (grey ? gl::define("GREY") : ""));
  }
  const AffineTransform to_padded = padded_from_world(volume.grid());
  const SliceFrame frame = frame_of(camera.axis);
  program->use();
  int unit = volume.bind(*program, 0);
  program->set_texture("u_index", unit++, GL_TEXTURE_3D, volume.index().name());
  program->set_texture("u_looks", unit++, GL_TEXTURE_2D, looks.texture().name());
  if (posed) unit = posed->bind(volume, *program, unit);
  if (weights) {
    unit = weights->bind(volume, *program, unit);
    program->set("u_contours", contours ? 1.0f : 0.0f);
  }
  if (grey) {
    grey->bind(volume, *program, unit);
    const double black = grey->level_of(shown_grey.level - shown_grey.width / 2),
                 white = grey->level_of(shown_grey.level + shown_grey.width / 2);
    program->set("u_window", glm::vec2(black, 1 / std::max(white - black, 1e-9)));
    program->set("u_over", shown_grey.tissues);
  }
  program->set("u_middle", glm::vec3(to_padded * camera.centre));
  program->set("u_right", glm::vec3(to_padded.linear * frame.right * camera.millimetres_per_pixel));
  program->set("u_down", glm::vec3(to_padded.linear * frame.down * camera.millimetres_per_pixel));
  program->set("u_high", glm::vec3(volume.layout().blocks * kBlock));
  program->set("u_size", glm::vec2(size));
  program->set("u_line", std::max(1.0f, std::round(line_scale)));
  program->set("u_outline", display == SliceDisplay::Outline ? 1 : 0);
  program->set("u_outlined", static_cast<unsigned>(outlined.value_or(0)));
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
  glViewport(0, 0, size.x, size.y);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
