// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/looks_texture.h"

#include <algorithm>
#include <cmath>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

constexpr size_t kLabels = 65536;

std::uint8_t in_steps(float value, int steps) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * float(steps))); }

}  // namespace

LooksTexture::LooksTexture(const LabelLooks& looks) : texture_(gl::Texture::create()), visible_(kLabels), bones_(kLabels) {
  std::vector<glm::u8vec4> texels(kLabels, glm::u8vec4(0));
  for (size_t label = 1; label < std::min(looks.size(), kLabels); ++label) {
    const LabelLook& look = looks[label];
    visible_[label] = look.visible && look.opacity > 0;
    bones_[label] = visible_[label] && look.bone;
    const int bits = visible_[label] | bones_[label] << 1 | in_steps(look.opacity, 63) << 2;
    texels[label] = {in_steps(look.colour.r, 255), in_steps(look.colour.g, 255), in_steps(look.colour.b, 255), static_cast<std::uint8_t>(bits)};
  }
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8UI, 256, 256, 0, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, texels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

}  // namespace limber::render
