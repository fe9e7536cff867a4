// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/volume_pass.h"

#include <algorithm>
#include <cmath>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

// The gradient at a hit is computed from four samples of the field, this far from the hit along each axis, voxels. This
// distance smooths the steps between voxels. It is less than 2 voxels, because the atlas stores only 2 voxels around
// each block.
constexpr float kTap = 1.4f;

void set_scissor(const PixelRect& rect) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, std::max(rect.high.x - rect.low.x, 0), std::max(rect.high.y - rect.low.y, 0));
}

void attach(const gl::Texture& texture, const glm::ivec2& size, GLint internal, GLenum pixels, GLenum type,
            GLenum attachment) {
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, internal, size.x, size.y, 0, pixels, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture.name(), 0);
}

bool inside(const glm::dvec3& point, const glm::vec3& low, const glm::vec3& high, double margin) {
  return glm::all(glm::greaterThan(point, glm::dvec3(low) - margin)) &&
         glm::all(glm::lessThan(point, glm::dvec3(high) + margin));
}

// Returns true if the eye is inside the box around the hull (the faces around the visible tissue, at which rays start).
// The eye then sees no front faces of the hull, so rays start at the near plane.
bool eye_inside(const Hull& hull, const ViewRays& rays) {
  if (!rays.perspective) return false;  // the depth range of an orthographic camera begins before the body
  const double voxels_per_depth = glm::length(rays.toward) + glm::length(rays.toward_x) + glm::length(rays.toward_y);
  return inside(rays.eye, hull.low(), hull.high(), rays.nearest * voxels_per_depth);
}

}  // namespace

std::string march_defines(int atlases, VolumePass::Space space) {
  return atlas_defines(atlases) + gl::define("SURFACE", kSurface) + gl::define("BRICK", kBrick) +
         (space == VolumePass::Space::Posed ? gl::define("POSED") : "");
}

void set_clip(gl::Program& program, const Hull& hull, const VolumeTexture& volume, const Clip& clip,
              const ViewRays& rays) {
  glm::vec3 low = hull.low(), high = hull.high();
  if (clip.box) {
    // Padded coordinates count voxels of the drawn volume. Its voxels are larger than the original ones if it is drawn
    // at a coarser resolution.
    const double scale = 1.0 / (1 << volume.halvings());
    low = glm::max(low, glm::vec3(((*clip.box)[0] + 0.5) * scale + double(kPad)));
    high = glm::min(high, glm::vec3(((*clip.box)[1] + 0.5) * scale + double(kPad)));
  }
  program.set("u_low", low);
  program.set("u_high", high);
  program.set("u_plane", clip.plane ? glm::vec4(rays.padded_from_clip_plane((*clip.plane)[0], (*clip.plane)[1]))
                                    : glm::vec4(0, 0, 0, 1));
}

PixelRect intersection(const PixelRect& a, const PixelRect& b) {
  return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

void GBuffer::resize(const glm::ivec2& size, bool places) {
  if (size == size_ && places == bool(place)) return;
  if (places && !place) {
    place = gl::Texture::create();
    weight = gl::Texture::create();
    weight_target = gl::Framebuffer::create();
  }
  if (!hull_target) {
    for (gl::Texture* texture : {&depth, &normal, &label, &range, &hull_depth}) *texture = gl::Texture::create();
    hull_target = gl::Framebuffer::create();
    march_target = gl::Framebuffer::create();
  }
  size_ = size;
  glBindFramebuffer(GL_FRAMEBUFFER, hull_target.name());
  attach(range, size, GL_RG32F, GL_RG, GL_FLOAT, GL_COLOR_ATTACHMENT0);
  attach(hull_depth, size, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, GL_DEPTH_ATTACHMENT);
  glBindFramebuffer(GL_FRAMEBUFFER, march_target.name());
  attach(depth, size, GL_R32F, GL_RED, GL_FLOAT, GL_COLOR_ATTACHMENT0);
  attach(normal, size, GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, GL_COLOR_ATTACHMENT1);
  attach(label, size, GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, GL_COLOR_ATTACHMENT2);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, hull_depth.name(), 0);
  const GLenum targets[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2, GL_COLOR_ATTACHMENT3};
  if (place) attach(place, size, GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, GL_COLOR_ATTACHMENT3);
  glDrawBuffers(place ? 4 : 3, targets);
  if (place) {
    glBindFramebuffer(GL_FRAMEBUFFER, weight_target.name());
    attach(weight, size, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_COLOR_ATTACHMENT0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, hull_depth.name(), 0);
  }
  gl::check_gl("the buffers of a picture");
}

void GBuffer::forget_hits() {
  glBindFramebuffer(GL_FRAMEBUFFER, march_target.name());
  glDisable(GL_SCISSOR_TEST);
  const float nothing[4] = {0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 1, nothing);
}

VolumePass::VolumePass(int atlases, Space space)
    : hull_("hull.vert", "hull.frag"),
      march_(gl::kWholePicture, "march.frag", march_defines(atlases, space)),
      nothing_(gl::VertexArray::create()) {}

float place_step(const VolumeTexture& volume) {
  const glm::ivec3 extent = volume.layout().blocks * kBlock;
  return static_cast<float>(std::max({extent.x, extent.y, extent.z})) / 65535.0f;
}

PixelRect VolumePass::covered(const Hull& hull, const ViewRays& rays, const glm::ivec2& size) {
  return hull.empty() ? PixelRect{} : covered(hull.low(), hull.high(), rays, size);
}

PixelRect VolumePass::covered(const glm::vec3& box_low, const glm::vec3& box_high, const ViewRays& rays,
                              const glm::ivec2& size) {
  const PixelRect whole = {{0, 0}, size};
  glm::dvec2 low(1e30), high(-1e30);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 padded(corner & 1 ? box_high.x : box_low.x, corner & 2 ? box_high.y : box_low.y,
                            corner & 4 ? box_high.z : box_low.z);
    const glm::dvec4 clip = rays.clip_from_padded * glm::dvec4(padded, 1);
    if (clip.w < 1e-6) return whole;
    const glm::dvec2 pixel = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(size);
    low = glm::min(low, pixel);
    high = glm::max(high, pixel);
  }
  low = glm::clamp(low - 1.0, glm::dvec2(0), glm::dvec2(size));
  high = glm::clamp(high + 2.0, glm::dvec2(0), glm::dvec2(size));
  return intersection(whole, {glm::ivec2(low), glm::ivec2(high)});
}

void VolumePass::draw_hull(const Hull& hull, const ViewRays& rays, const GBuffer& buffer, const PixelRect& rect) {
  glBindFramebuffer(GL_FRAMEBUFFER, buffer.hull_target.name());
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  set_scissor(rect);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  const float far = 1, nothing[4] = {-kNothingDepth, -kNothingDepth, 0, 0};
  glClearBufferfv(GL_DEPTH, 0, &far);
  glClearBufferfv(GL_COLOR, 0, nothing);
  // The depth buffer only has to mark the pixels that the hull covers, so any depth in front of the far plane will do.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  glEnable(GL_BLEND);
  glBlendEquation(GL_MAX);
  hull_.use();
  hull_.set("u_clip", glm::mat4(rays.clip_from_padded * hull.padded_from_corner()));
  hull_.set("u_depth", glm::vec4(rays.depth_of_padded * hull.padded_from_corner()));
  hull_.set("u_front_is_clockwise", glm::determinant(glm::dmat3(rays.padded_from_world)) < 0 ? 1 : 0);
  hull.draw();
  glBlendEquation(GL_FUNC_ADD);
  glDisable(GL_BLEND);
}

void VolumePass::march(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
                       const PosedHull* posed_hull, const gl::Texture& looks, int layer, const Clip& clip,
                       const ViewRays& rays, const GBuffer& buffer, const PixelRect& rect) {
  const Hull& hull = posed_hull ? posed_hull->hull() : field.hull();
  glBindFramebuffer(GL_FRAMEBUFFER, buffer.march_target.name());
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  set_scissor(rect);
  glDisable(GL_BLEND);
  const float depth[4] = {kNothingDepth, 0, 0, 0}, normal[4] = {0, 0, 0, 0};
  const GLuint label[4] = {0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, depth);
  glClearBufferfv(GL_COLOR, 1, normal);
  glClearBufferuiv(GL_COLOR, 2, label);
  if (buffer.place) glClearBufferuiv(GL_COLOR, 3, label);
  if (hull.empty()) return;

  // Draws one triangle over the whole picture, at the far plane. Only pixels where the hull of the visible tissue was
  // drawn in front of this triangle pass the depth test, so all other pixels are skipped.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  march_.use();
  int unit = volume.bind(march_, 0);
  unit = field.bind(volume, march_, unit);
  if (posed) {
    unit = posed->bind(volume, march_, unit);
    march_.set_texture("u_near_cubes", unit++, GL_TEXTURE_3D, posed_hull->cubes().name());
    march_.set("u_blocks", volume.layout().blocks);
  }
  march_.set_texture("u_range", unit++, GL_TEXTURE_2D, buffer.range.name());
  march_.set("u_nearest", eye_inside(hull, rays) ? static_cast<float>(rays.nearest) : -kNothingDepth);
  march_.set("u_label_shift", rays.label_shift);
  march_.set("u_smooth_cuts", rays.smooth_cuts ? 1 : 0);
  march_.set("u_places", 1.0f / place_step(volume));
  march_.set("u_tap", rays.mirrored_taps ? -kTap : kTap);
  march_.set_texture("u_looks", unit++, GL_TEXTURE_2D, looks.name());
  march_.set("u_layer", static_cast<unsigned>(layer));
  set_rays(march_, rays);
  march_.set("u_view_from_gradient", glm::mat3(rays.view_from_gradient));
  set_clip(march_, hull, volume, clip, rays);
  march_.set("u_clipped", clip.box || clip.plane ? 1 : 0);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
