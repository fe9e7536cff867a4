// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose_library.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "editor/handling.h"
#include "editor/icons.h"
#include "editor/panels/column.h"
#include "editor/panels/panels.h"
#include "editor/posing.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

constexpr int kAcross = 3;
constexpr float kPicture = 63, kWords = 22;      // heights
constexpr double kFirstPixels = 4, kPixels = 200;  // before a drag begins; for the whole way

void draw_picture(Editor& editor, const NamedPose& pose, const Rect& rect) {
  const Look& look = editor.look;
  fill(rect, look.theme.view_bottom, look.px(4));
  unsigned texture = 0;
  if (!pose.picture.empty()) {
    const std::string key = "pose " + std::to_string(std::hash<std::string>{}(pose.picture));
    texture = editor.pictures.texture(key, [&] { return render::parse_png(pose.picture, pose.name); });
  }
  if (!texture) return put_icon(look.fonts.regular, look.theme.view_text2, rect, icon::kPose);
  // What the picture has beyond the card's shape is cut at its sides.
  const float cut = (1 - rect.width() / rect.height() / 1.5f) / 2;
  ImGui::GetWindowDrawList()->AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), im(rect.low), im(rect.high), {cut, 0}, {1 - cut, 1}, 0xFFFFFFFF, look.px(4));
}

// A press in place applies the pose when it ends; a press that goes sideways blends towards it, and Escape leaves it.
void take_press(Editor& editor, const NamedPose& pose, const Pressed& pressed) {
  auto& drag = editor.handling->library_drag;
  if (pressed.activated) {
    editor.handling->library_pose = pose.name;
    drag = {pose.name, editor.input.pointer.x, false};
  }
  if (drag.pose != pose.name) return;
  const double way = editor.input.pointer.x - drag.begin, scale = editor.look.scale, share = std::clamp(way / (kPixels * scale), 0.0, 1.0);
  if (editor.input.down(Key::Escape)) {
    drag = {};
    drop_shown_pose(editor);
    return;
  }
  if (pressed.held) {
    drag.moved = drag.moved || std::abs(way) >= kFirstPixels * scale;
    if (drag.moved) show_pose(editor, on_the_way_to(editor, pose, share));
    return;
  }
  const bool moved = drag.moved;
  drag = {};
  const NamedPose named = pose;  // the document changes
  if (moved) apply_pose(editor, named, share);
  else if (pressed.clicked) apply_pose(editor, named, 1);
}

void draw_card(Editor& editor, const NamedPose& pose, const Rect& rect) {
  const Look& look = editor.look;
  const Rect picture{rect.low, {rect.high.x, rect.low.y + look.px(kPicture)}};
  const bool chosen = editor.handling->library_pose == pose.name;
  const Pressed pressed = press_area(editor, pose.name, rect);
  draw_picture(editor, pose, picture);
  const float width = chosen ? 2 * look.line() : look.line();
  ImGui::GetWindowDrawList()->AddRect(im(picture.low), im(picture.high), chosen ? look.theme.select : pressed.hovered ? look.theme.text2 : look.theme.line2, look.px(4), 0, width);
  const auto& drag = editor.handling->library_drag;
  if (drag.pose == pose.name && drag.moved) {
    const float share = std::clamp((editor.input.pointer.x - drag.begin) / static_cast<float>(kPixels * look.scale), 0.0f, 1.0f);
    fill({{picture.low.x, picture.high.y - look.px(4)}, {picture.low.x + share * picture.width(), picture.high.y}}, look.theme.select, look.px(2));
  }
  put_text(editor, look.fonts.small, chosen ? look.theme.text : look.theme.text2, Rect{{rect.low.x, picture.high.y}, rect.high}, pose.name, Align::Centre);
  if (pressed.hovered && !pressed.held) tooltip(editor, rect, pose.name, "Click: the chosen bones take it, or all. Drag sideways: a part of the way.");
  if (pressed.right_clicked) {
    editor.handling->library_pose = pose.name;
    editor.open_popup = "Pose library";
  }
  take_press(editor, pose, pressed);
}

}  // namespace

void draw_pose_library(Editor& editor, Column& column) {
  if (!editor.document().armature) return;
  const Look& look = editor.look;
  const bool open = column.begin_section("Pose library", "", false);
  const Rect head = column.head();
  operator_button(editor, "pose.library_add", {{head.high.x - look.px(34), head.low.y + look.px(2)}, {head.high.x - look.px(6), head.high.y - look.px(2)}}, "");
  if (open) {
    const PoseLibrary library = editor.document().poses;
    column.space(8);
    if (library.empty()) {
      const Operator* op = find_operator(editor, "pose.library_add");
      if (empty_state(editor, column.row(72), "No poses yet", op->label)) run(editor, *op);
    }
    for (std::size_t first = 0; first < library.size(); first += kAcross) {
      const Rect row = column.row(kPicture + kWords + 4);
      const float gap = look.px(8), left = row.low.x + look.px(10), width = (row.width() - look.px(20) - (kAcross - 1) * gap) / kAcross;
      for (std::size_t i = first; i < std::min(first + kAcross, library.size()); ++i) {
        const float x = std::round(left + static_cast<float>(i - first) * (width + gap));
        draw_card(editor, *library[i], {{x, row.low.y}, {std::round(x + width), row.low.y + look.px(kPicture + kWords)}});
      }
    }
    column.space(4);
  }
  column.end_section();
}

}  // namespace limber::editor
