// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/timeline_faces.h"

#include "editor/context/context.h"
#include "editor/context/operator_button.h"
#include "editor/context/screen.h"
#include "editor/motion/graph.h"
#include "editor/motion/strip_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr const char* kNames[] = {"Keys", "Curves", "Strips"};
constexpr const char* kOperators[] = {"motion.show_rows", "graph.show", "strips.show"};

}  // namespace

TimelineFace shown_face(const Timeline& timeline) {
  return timeline.shows_strips ? TimelineFace::Strips : timeline.shows_graph ? TimelineFace::Graph : TimelineFace::Rows;
}

void show_face(Context& context, TimelineFace face) {
  if (context.timeline->shows_graph) show_graph(context, false);
  context.timeline->shows_strips = false;
  if (face == TimelineFace::Graph) show_graph(context, true);
  if (face == TimelineFace::Strips) show_strips(context, true);
  Arrangement& arrangement = context.screen->arrangement();
  arrangement.timeline = true;
  arrangement.console = false;
  context.ui->touch();
}

void draw_face_switch(Context& context, const Rect& place) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "face", place);
  fill(place, pressed.hovered ? look.theme.hover : look.theme.raised, look.px(4));
  const Rect words{{place.low.x + look.px(4), place.low.y}, {place.high.x - look.px(13), place.high.y}};
  put_text(context.ui, look.fonts.small, look.theme.text, words,
           kNames[static_cast<int>(shown_face(context.timeline))]);
  put_icon(look.fonts.regular, look.theme.text2, Rect{{place.high.x - look.px(15), place.low.y}, place.high},
           icon::kOpened);
  if (pressed.hovered)
    tooltip(context.ui, place, "Timeline view",
            "Show the clip's keys, its curves, or its strips. Ctrl+Tab switches to the next of these views.");
  if (pressed.clicked) ImGui::OpenPopup("faces");
  if (!ImGui::BeginPopup("faces", ImGuiWindowFlags_NoMove)) return;
  const Region region = context.ui->place.region;
  context.ui->place.region = Region::Popup;
  for (const char* id : kOperators) operator_menu_item(context, id);
  context.ui->place.region = region;
  ImGui::EndPopup();
}

}  // namespace limber::editor
