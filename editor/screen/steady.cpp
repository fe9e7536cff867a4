// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/screen/steady.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <imgui_internal.h>

#include "editor/context/context.h"
#include "editor/context/outliner_state.h"
#include "editor/context/screen.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Keys of the values that this file stores in the state storage of the sidebar's ImGui window.
constexpr ImGuiID kShift = 1, kWidget = 2, kLow = 3, kHigh = 4, kScroll = 5, kState = 6, kHead = 7, kSection = 8,
                  kEnd = 9;

ImGuiWindow* sidebar() {
  ImGuiWindow* window = ImGui::FindWindowByName("##sidebar");
  return window && window->Active ? window : nullptr;
}

// Returns the sum of the scroll positions of the sidebar and of the child windows in it, pixels.
float scroll_of(const ImGuiWindow& sidebar) {
  float scroll = 0;
  for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
    if (window->Active && window->RootWindow == &sidebar) scroll += window->Scroll.y;
  return scroll;
}

ImGuiID id_of(const Widget& widget) { return ImHashStr(widget.name.c_str()); }

// Returns the smallest widget of the sidebar under the pointer; null if there is no widget.
const Widget* pointed_at(const Context& context) {
  const Widget* found = nullptr;
  for (const Widget& widget : context.ui->widgets.widgets())
    if (widget.region == Region::Sidebar && widget.rect.contains(context.ui->input.pointer) &&
        (!found || widget.rect.height() <= found->rect.height()))
      found = &widget;
  return found;
}

const Widget* with_id(const Ui& ui, ImGuiID id) {
  for (const Widget& widget : ui.widgets.widgets())
    if (widget.region == Region::Sidebar && id_of(widget) == id) return &widget;
  return nullptr;
}

// Returns the widget that must not move: the one under the pointer, or the field of a search.
const Widget* steady_widget(const Context& context) {
  if (context.screen->layout.sidebar.contains(context.ui->input.pointer)) return pointed_at(context);
  return context.outliner->searching ? context.ui->widgets.find("sections/Outliner/search") : nullptr;
}

// Scrolls the sidebar's sections. Returns by how many pixels they will be scrolled.
float scroll_sections(const ImGuiWindow& sidebar, float by) {
  for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
    if (!window->Active || window->ParentWindow != &sidebar || window->Size.y < 0.9f * sidebar.Size.y) continue;
    const float content = window->DC.CursorMaxPos.y - window->DC.CursorStartPos.y;
    const float scroll =
        std::clamp(window->Scroll.y + by, 0.0f, std::max(0.0f, content - window->InnerRect.GetHeight()));
    const float way = scroll - window->Scroll.y;
    window->Scroll.y = scroll;
    return way;
  }
  return 0;
}

// Returns the id of the widget's section: "sidebar/sections/Bone/Length" is in the section Bone.
ImGuiID section_of(const Widget& widget) {
  constexpr std::string_view kSections = "sidebar/sections/";
  if (!widget.name.starts_with(kSections)) return 0;
  const std::string rest = widget.name.substr(kSections.size());
  return ImHashStr(rest.substr(0, rest.find('/')).c_str());
}

// Returns the distance that a widget has moved down since note() stored its position, pixels. The distance is measured
// at the widget's upper end, or at its lower end if the sidebar's top edge clips the widget.
float way_of(const Widget& widget, const ImGuiStorage& noted, const Rect& sidebar) {
  const bool clipped = widget.rect.low.y <= sidebar.low.y || noted.GetFloat(kLow) <= sidebar.low.y;
  return clipped ? widget.rect.high.y - noted.GetFloat(kHigh) : widget.rect.low.y - noted.GetFloat(kLow);
}

// Stores the widget that must not move on the screen, with its current position. Null: any widget may move.
void note(ImGuiStorage& noted, const Widget* widget, float scroll) {
  noted.SetInt(kWidget, widget ? static_cast<int>(id_of(*widget)) : 0);
  noted.SetFloat(kScroll, scroll);
  if (!widget) return;
  noted.SetFloat(kLow, widget->rect.low.y);
  noted.SetFloat(kHigh, widget->rect.high.y);
  noted.SetInt(kSection, static_cast<int>(section_of(*widget)));
  noted.SetFloat(kHead, noted.GetFloat(section_of(*widget)));
}

}  // namespace

float sidebar_shift() { return ImGui::GetStateStorage()->GetFloat(kShift); }

float sidebar_rest(float end) {
  ImGuiStorage& noted = ImGui::GetCurrentWindow()->RootWindow->StateStorage;
  const float whole = noted.GetInt(kWidget) != 0 ? std::max(noted.GetFloat(kEnd), end) : end;
  noted.SetFloat(kEnd, whole);
  return whole - end;
}

bool has_moved_under_pointer(Context& context) {
  ImGuiWindow* window = sidebar();
  if (!window) return false;
  ImGuiStorage& noted = window->StateStorage;
  const Rect& rect = context.screen->layout.sidebar;
  const float shift = noted.GetFloat(kShift), scroll = scroll_of(*window);
  // Reset the shift if the workspace or the sidebar's size has changed, or if the pointer has left the sidebar.
  const int state = static_cast<int>(context.workspace()) + 8 * static_cast<int>(rect.width()) +
                    65536 * static_cast<int>(rect.height());
  const bool same = noted.GetInt(kState) == state, held = context.ui->input.down(MouseButton::Left);
  const bool points = held || rect.contains(context.ui->input.pointer);
  if (!same || (!points && (shift != 0 || !steady_widget(context)))) {
    noted.SetInt(kWidget, 0);
    noted.SetInt(kState, state);
    noted.SetFloat(kShift, 0);
    return shift != 0;
  }
  const bool scrolled = scroll != noted.GetFloat(kScroll) || context.ui->input.wheel != 0;
  const ImGuiID id = static_cast<ImGuiID>(noted.GetInt(kWidget));
  const Widget* widget = id != 0 && !scrolled ? with_id(context.ui, id) : nullptr;
  const ImGuiID section = static_cast<ImGuiID>(noted.GetInt(kSection));
  float way = widget ? std::round(way_of(*widget, noted, rect)) : 0;
  // If the stored widget is not drawn any more, use the distance that the heading of its section has moved.
  if (id != 0 && !scrolled && !widget && section != 0)
    way = std::round(noted.GetFloat(section) - noted.GetFloat(kHead));
  if (way != 0) {
    const float scrolled_by = scroll_sections(*window, way);
    noted.SetFloat(kScroll, scroll + scrolled_by);
    if (points) noted.SetFloat(kShift, shift - (way - scrolled_by));
    if (points || scrolled_by != 0) return true;
  }
  const Widget* now = held && id != 0 ? with_id(context.ui, id) : steady_widget(context);
  note(noted, now, scroll);
  return false;
}

void note_pressed(const Context& context) {
  if (ImGuiWindow* window = sidebar()) note(window->StateStorage, pointed_at(context), scroll_of(*window));
}

}  // namespace limber::editor
