// SPDX-License-Identifier: AGPL-3.0-or-later
// Small pictures as textures, each uploaded once and known by a name. Lives no longer than the context.
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

  // The texture of that name; `read` gives its picture the first time. 0 when there is none: an empty picture, or
  // Error.
  unsigned texture(const std::string& name, const std::function<render::Image()>& read);
  void forget(const std::string& name);
  void clear();

 private:
  std::map<std::string, unsigned> textures_;
};

}  // namespace limber::editor
