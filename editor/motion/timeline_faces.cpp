// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/timeline_faces.h"

#include "editor/context/operator_button.h"
#include "editor/motion/graph.h"
#include "editor/motion/strip_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr const char* kNames[] = {"Keys", "Curves", "Strips"};
constexpr const char* kOperators[] = {"motion.show_rows", "graph.show", "strips.show"};

}  // namespace

TimelineFace shown_face(const Editor& editor) {
  return editor.timeline->shows_strips  ? TimelineFace::Strips
         : editor.timeline->shows_graph ? TimelineFace::Graph
                                        : TimelineFace::Rows;
}

void show_face(Editor& editor, TimelineFace face) {
  if (editor.timeline->shows_graph) show_graph(editor, false);
  editor.timeline->shows_strips = false;
  if (face == TimelineFace::Graph) show_graph(editor, true);
  if (face == TimelineFace::Strips) show_strips(editor, true);
  Arrangement& arrangement = editor.arrangement();
  arrangement.timeline = true;
  arrangement.console = false;
  editor.touch();
}

void draw_face_switch(Editor& editor, const Rect& place) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "face", place);
  fill(place, pressed.hovered ? look.theme.hover : look.theme.raised, look.px(4));
  const Rect words{{place.low.x + look.px(4), place.low.y}, {place.high.x - look.px(13), place.high.y}};
  put_text(editor, look.fonts.small, look.theme.text, words, kNames[static_cast<int>(shown_face(editor))]);
  put_icon(look.fonts.regular, look.theme.text2, Rect{{place.high.x - look.px(15), place.low.y}, place.high},
           icon::kOpened);
  if (pressed.hovered)
    tooltip(editor, place, "Timeline view",
            "Show the clip's keys, its curves, or its strips. Ctrl+Tab switches to the next of these views.");
  if (pressed.clicked) ImGui::OpenPopup("faces");
  if (!ImGui::BeginPopup("faces", ImGuiWindowFlags_NoMove)) return;
  const Region region = editor.place.region;
  editor.place.region = Region::Popup;
  for (const char* id : kOperators) operator_menu_item(editor, id);
  editor.place.region = region;
  ImGui::EndPopup();
}

}  // namespace limber::editor
