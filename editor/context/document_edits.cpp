// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/document_edits.h"

#include <utility>

#include <backends/imgui_impl_opengl3.h>

#include "core/project/strip_clips.h"

namespace limber::editor {

float scale_for(const Preferences& preferences, const Host& host) {
  // The scale changes in steps of this size, so that fonts are not rebuilt at every pixel of a window resize.
  constexpr double kStep = 0.25;
  const glm::dvec2 most = glm::dvec2(host.size()) / glm::dvec2(800, 520);
  const double fitting = std::floor(std::min(most.x, most.y) / kStep) * kStep;
  return static_cast<float>(glm::clamp(std::min(preferences.scale * host.monitor_scale(), fitting), 0.75, 6.0));
}

void commit(Editor& editor, const std::string& label, Document next) {
  relink_strips(editor.document(), next);
  editor.history.commit(label, std::move(next));
  editor.touch();
}

bool apply_look_if_changed(Editor& editor) {
  const float scale = scale_for(editor.preferences, editor.host);
  if (scale == editor.look.scale && editor.shown_theme == editor.preferences.theme) return false;
  editor.shown_theme = editor.preferences.theme;
  if (apply_look(editor.look, editor.preferences.theme, scale))
    ImGui_ImplOpenGL3_DestroyFontsTexture(), ImGui_ImplOpenGL3_CreateFontsTexture();
  return true;
}

}  // namespace limber::editor
