// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/image_pass.h"

#include <algorithm>

#include <epoxy/gl.h>

#include "render/scene/grey_transfer.h"

namespace limber::render {

ImagePass::ImagePass() : transfer_(gl::Texture::create()), nothing_(gl::VertexArray::create()) {}

std::array<glm::dvec3, 2> ImagePass::box(const VolumeTexture& volume, const PosedTexture* posed,
                                         const GreyTexture& grey) {
  if (!posed) return grey.padded_box(volume);
  const PreviewMap& map = *posed->map();
  const double halving = 1 << volume.halvings();
  const auto place_of_node = [&](const glm::dvec3& node) {
    const glm::dvec3 voxel = (node + 0.5 + glm::dvec3(map.first)) * double(map.step) - 0.5;
    return (voxel + 0.5) / halving + double(kPad);
  };
  return {place_of_node(glm::dvec3(0)), place_of_node(glm::dvec3(map.size - 1))};
}

void ImagePass::upload_transfer(const ShownGrey& shown) {
  if (transfer_of_ == shown) return;
  const GreyTransfer transfer = transfer_of(shown);
  glBindTexture(GL_TEXTURE_2D, transfer_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, GreyTransfer::kSamples, 1, 0, GL_RGBA, GL_FLOAT, transfer.samples.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, axis, GL_CLAMP_TO_EDGE);
  transfer_of_ = shown;
}

void ImagePass::draw(const VolumeTexture& volume, const PosedTexture* posed, const GreyTexture& grey,
                     const ShownGrey& shown, const Clip& clip, const ViewRays& rays, double step, const PixelRect& rect,
                     const glm::ivec2& size) {
  const bool maximum = shown.rendering == GreyRendering::Maximum;
  auto& program = programs_[{posed != nullptr, maximum}];
  if (!program)
    program = std::make_unique<gl::Program>(
        gl::kWholePicture, "image.frag",
        std::string(posed ? gl::define("POSED") : "") + (maximum ? gl::define("MAXIMUM") : ""));
  upload_transfer(shown);
  glViewport(0, 0, size.x, size.y);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, std::max(0, rect.high.x - rect.low.x), std::max(0, rect.high.y - rect.low.y));
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  program->use();
  set_rays(*program, rays);
  int unit = grey.bind(volume, *program, 0);
  if (posed) unit = posed->bind(volume, *program, unit);
  program->set_texture("u_transfer", unit++, GL_TEXTURE_2D, transfer_.name());
  const GreyTransfer transfer = transfer_of(shown);
  const double low = grey.level_of(transfer.low), high = grey.level_of(transfer.high);
  program->set("u_values", glm::vec2(low, 1 / std::max(high - low, 1e-9)));
  const Grid& grid = grey.grid();
  program->set("u_step", static_cast<float>(step * std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z})));
  program->set("u_view_from_gradient", glm::mat3(rays.view_from_gradient));
  program->set("u_nearest", static_cast<float>(rays.nearest));
  auto [box_low, box_high] = box(volume, posed, grey);
  if (clip.box) {
    const double scale = 1.0 / (1 << volume.halvings());
    box_low = glm::max(box_low, ((*clip.box)[0] + 0.5) * scale + double(kPad));
    box_high = glm::min(box_high, ((*clip.box)[1] + 0.5) * scale + double(kPad));
  }
  program->set("u_low", glm::vec3(box_low));
  program->set("u_high", glm::vec3(box_high));
  program->set("u_plane", clip.plane ? glm::vec4(rays.padded_from_clip_plane((*clip.plane)[0], (*clip.plane)[1]))
                                     : glm::vec4(0, 0, 0, 1));
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
