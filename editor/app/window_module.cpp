// SPDX-License-Identifier: AGPL-3.0-or-later
// Loads the module limber_window.so, which contains GLFW.
#include "core/base/error.h"
#include "core/platform/module.h"
#include "editor/app/glfw_window.h"

namespace limber::editor {

std::unique_ptr<Host> open_window(const glm::ivec2& size, const std::string& title) {
  void* module = open_module("limber_window");
  const auto open =
      module ? reinterpret_cast<decltype(&limber_open_window)>(symbol_of(module, "limber_open_window")) : nullptr;
  if (!open)
    throw Error("windows cannot be opened on this system", "limber_window.so",
                "install libx11-6, or install Limber again if the file is missing; commands work without a window "
                "(limber --help)");
  return std::unique_ptr<Host>(open(size, title));
}

}  // namespace limber::editor
