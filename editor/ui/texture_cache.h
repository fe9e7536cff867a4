// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps small pictures as OpenGL textures. Each picture is uploaded once and found by its name. The cache must be
// destroyed before the OpenGL context.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "render/image_io.h"

namespace limber::editor {

class Pictures {
 public:
  Pictures() = default;
  ~Pictures() { clear(); }
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  // Returns the texture with the name `name`. The first call for a name makes the texture from the picture that `read`
  // returns. The texture is 0 if the picture is empty or `read` throws Error.
  unsigned texture(const std::string& name, const std::function<render::Image()>& read);
  void forget(const std::string& name);
  void clear();

 private:
  std::map<std::string, unsigned> textures_;
};

}  // namespace limber::editor
