// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/picture_blit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <epoxy/gl.h>
#include <imgui.h>

namespace limber::editor {

namespace {

// Packs the corners of a rectangle into the bits of one pointer. ImGui keeps that pointer for the callback, so nothing
// else has to live until the frame is drawn.
void* packed(const Rect& rect) {
  std::uint64_t bits = 0;
  for (const float edge : {rect.low.x, rect.low.y, rect.high.x, rect.high.y})
    bits = bits << 16 | static_cast<std::uint16_t>(std::lround(std::max(edge, 0.0f)));
  return reinterpret_cast<void*>(bits);
}

void blit(const ImDrawList*, const ImDrawCmd* command) {
  const auto bits = reinterpret_cast<std::uint64_t>(command->UserCallbackData);
  const auto edge = [&](int index) { return static_cast<GLint>(bits >> (16 * (3 - index)) & 0xffff); };
  GLint window = 0, view[4], size[2];
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &window);
  glGetIntegerv(GL_VIEWPORT, view);
  GLuint source = 0;
  glGenFramebuffers(1, &source);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, source);
  const auto texture = static_cast<GLuint>(reinterpret_cast<std::uintptr_t>(command->TextureId));
  glBindTexture(GL_TEXTURE_2D, texture);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &size[0]);
  glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &size[1]);
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  const ImVec4& clip = command->ClipRect;
  glScissor(int(clip.x), int(float(view[3]) - clip.w), int(clip.z - clip.x), int(clip.w - clip.y));
  // OpenGL counts rows from the bottom of the window, so the y coordinates are flipped.
  glBlitFramebuffer(0, 0, size[0], size[1], edge(0), view[3] - edge(3), edge(2), view[3] - edge(1), GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(window));
  glDeleteFramebuffers(1, &source);
}

}  // namespace

void blit_picture(unsigned texture, const Rect& rect) {
  if (!texture) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushTextureID(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)));
  list.AddCallback(blit, packed(rect));
  list.PopTextureID();
}

}  // namespace limber::editor
