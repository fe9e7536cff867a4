// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/document_edits.h"

#include <utility>

#include <backends/imgui_impl_opengl3.h>

#include "core/project/history.h"
#include "core/project/strip_clips.h"
#include "editor/context/context.h"
#include "editor/context/platform_window.h"
#include "editor/context/preferences.h"
#include "editor/context/preferences_state.h"
#include "editor/ui/ui.h"

namespace limber::editor {

float scale_for(const Preferences& preferences, const Host& host) {
  // The scale changes in steps of this size, so that fonts are not rebuilt at every pixel of a window resize.
  constexpr double kStep = 0.25;
  const glm::dvec2 most = glm::dvec2(host.size()) / glm::dvec2(800, 520);
  const double fitting = std::floor(std::min(most.x, most.y) / kStep) * kStep;
  return static_cast<float>(glm::clamp(std::min(preferences.scale * host.monitor_scale(), fitting), 0.75, 6.0));
}

void commit(Context& context, const std::string& label, Document next) {
  relink_strips(context.document(), next);
  context.history->commit(label, std::move(next));
  context.ui->touch();
}

bool apply_look_if_changed(Context& context) {
  const float scale = scale_for(context.preferences, context.host);
  if (scale == context.ui->look.scale && context.preferences_state->shown_theme == context.preferences->theme)
    return false;
  context.preferences_state->shown_theme = context.preferences->theme;
  if (apply_look(context.ui->look, context.preferences->theme, scale))
    ImGui_ImplOpenGL3_DestroyFontsTexture(), ImGui_ImplOpenGL3_CreateFontsTexture();
  return true;
}

}  // namespace limber::editor
