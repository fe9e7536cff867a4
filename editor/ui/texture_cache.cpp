// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/texture_cache.h"

#include <epoxy/gl.h>

#include "core/base/error.h"

namespace limber::editor {

namespace {

unsigned upload(const render::Image& image) {
  if (image.rgba.empty()) return 0;
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.size.x, image.size.y, 0, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  return texture;
}

}  // namespace

unsigned Pictures::texture(const std::string& name, const std::function<render::Image()>& read) {
  if (const auto found = textures_.find(name); found != textures_.end()) return found->second;
  unsigned texture = 0;
  try {
    texture = upload(read());
  } catch (const Error&) {  // a picture that cannot be read is not shown
  }
  return textures_[name] = texture;
}

void Pictures::forget(const std::string& name) {
  const auto found = textures_.find(name);
  if (found == textures_.end()) return;
  if (found->second) glDeleteTextures(1, &found->second);
  textures_.erase(found);
}

void Pictures::clear() {
  for (const auto& [name, texture] : textures_)
    if (texture) glDeleteTextures(1, &texture);
  textures_.clear();
}

}  // namespace limber::editor
