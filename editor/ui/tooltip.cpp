// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/tooltip.h"

#include <utility>

#include <imgui_internal.h>

#include "editor/ui/draw.h"

namespace limber::editor {

namespace {

constexpr double kNever = 1e300;

// Returns true if a mouse button is down or a key other than a modifier was pressed in this frame.
bool is_acting(const Ui& ui) {
  for (const bool down : ui.input.buttons)
    if (down) return true;
  for (int button = 0; button < 3; ++button)
    if (ImGui::IsMouseClicked(button)) return true;
  for (int key = 0; key < static_cast<int>(Key::Count); ++key) {
    const Key one = static_cast<Key>(key);
    const bool modifier = one == Key::Ctrl || one == Key::Shift || one == Key::Alt || one == Key::Super;
    if (!modifier && ImGui::IsKeyPressed(key, false)) return true;
  }
  return false;
}

// Returns true from a click or a key until the pointer moves: the user knows what the widget does, and a tool tip could
// cover what has changed, even if another widget is under the pointer now. The place of the pointer is kept in the
// storage of ImGui's current window. Call it once per frame, outside the windows of all regions.
bool quiet_at_pointer(const Ui& ui) {
  ImGuiStorage& storage = *ImGui::GetStateStorage();
  const ImGuiID x = ImHashStr("quiet x"), y = ImHashStr("quiet y");
  const glm::vec2& pointer = ui.input.pointer;
  if (!is_acting(ui)) return storage.GetFloat(x, -FLT_MAX) == pointer.x && storage.GetFloat(y, -FLT_MAX) == pointer.y;
  storage.SetFloat(x, pointer.x);
  storage.SetFloat(y, pointer.y);
  return true;
}

}  // namespace

void tooltip(Ui& ui, const Rect& rect, const std::string& title, const std::string& description,
             const std::optional<Chord>& chord) {
  auto& tip = ui.tip;
  if (tip.widget != title || tip.rect != rect) {
    tip.widget = title;
    tip.rect = rect;
    tip.since = ui.now;
  }
  tip.title = title;
  tip.description = description;
  tip.chord = chord;
  tip.asked = true;
}

void draw_tooltip(Ui& ui) {
  auto& tip = ui.tip;
  // No tool tip is shown while the user types a number, since the tool tip would hide the fields below the number.
  const ImGuiID active = ImGui::GetActiveID();
  const bool typing = active != 0 && ImGui::TempInputIsActive(active), quiet = quiet_at_pointer(ui);
  if (!std::exchange(tip.asked, false) || typing) return tip.widget.clear();
  if (quiet) tip.since = kNever;
  if (tip.since > ui.now) return;
  if (ui.now - tip.since < ui.tooltip_delay) return ui.wake_at(tip.since + ui.tooltip_delay);

  const Look& look = ui.look;
  const float padding = look.px(10), widest = look.px(320);
  const std::vector<std::string> caps = tip.chord ? key_caps(*tip.chord) : std::vector<std::string>{};
  const float caps_width = caps.empty() ? 0 : look.px(12) + width_of_key_caps(ui, caps);
  const ImFont* font = look.fonts.regular;
  const glm::vec2 body = tip.description.empty()
                             ? glm::vec2(0)
                             : from_im(look.fonts.small->CalcTextSizeA(look.fonts.small->FontSize, FLT_MAX, widest,
                                                                       tip.description.c_str()));
  const glm::vec2 title = tip.title.empty()
                              ? glm::vec2(0)
                              : from_im(font->CalcTextSizeA(font->FontSize, FLT_MAX, widest, tip.title.c_str()));
  const float gap = tip.title.empty() || tip.description.empty() ? 0 : look.px(4);
  const glm::vec2 size{std::max(title.x + caps_width, body.x) + 2 * padding, title.y + gap + body.y + 2 * look.px(7)};
  glm::vec2 corner{tip.rect.low.x, tip.rect.high.y + look.px(6)};
  if (corner.y + size.y > ui.window.high.y) corner.y = tip.rect.low.y - look.px(6) - size.y;
  corner.x = std::clamp(corner.x, look.px(4), std::max(look.px(4), ui.window.high.x - size.x - look.px(4)));

  ImGui::SetNextWindowPos(im(corner));
  ImGui::SetNextWindowSize(im(size));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, 0);
  ImGui::Begin("##tooltip", nullptr,
               ImGuiWindowFlags_Tooltip | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoSavedSettings);
  const Rect rect{corner, corner + size};
  fill(rect, look.theme.panel, look.px(5));
  outline(rect, look.theme.line2, look.px(5), look.line());
  const glm::vec2 text = corner + glm::vec2(padding, look.px(7));
  if (!tip.title.empty()) put_wrapped(ui, look.fonts.regular, look.theme.text, text, widest, tip.title);
  put_key_caps(ui, rect.high.x - padding - caps_width + (caps.empty() ? 0 : look.px(12)), text.y + font->FontSize / 2,
               caps);
  if (!tip.description.empty())
    ImGui::GetWindowDrawList()->AddText(look.fonts.small, look.fonts.small->FontSize,
                                        im(text + glm::vec2(0, title.y + gap)), look.theme.text2,
                                        tip.description.c_str(), nullptr, widest);
  ImGui::End();
  ImGui::PopStyleColor();
}

}  // namespace limber::editor
