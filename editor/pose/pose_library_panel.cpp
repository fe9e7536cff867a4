// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/pose/pose_library.h"
#include "editor/ui/texture_cache.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/pose/body_poses.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/transform_settings.h"
#include "editor/pose/body_pose_cards.h"
#include "editor/pose/pose_edits.h"
#include "editor/ui/icons.h"
#include "editor/ui/section.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

constexpr int kAcross = 3;
constexpr float kPicture = 63, kWords = 22;  // heights of a card's picture and name, pixels at scale 1
// Pointer motion that begins a drag, and that blends fully to the card's pose, pixels at scale 1.
constexpr double kFirstPixels = 4, kPixels = 200;

void draw_picture(Context& context, const NamedPose& pose, const Rect& rect) {
  const Look& look = context.ui->look;
  fill(rect, look.theme.view_bottom, look.px(4));
  unsigned texture = 0;
  if (!pose.picture.empty()) {
    const std::string key = "pose " + std::to_string(std::hash<std::string>{}(pose.picture));
    texture = context.pictures->texture(key, [&] { return render::parse_png(pose.picture, pose.name); });
  }
  if (!texture) return put_icon(look.fonts.regular, look.theme.view_text2, rect, icon::kPose);
  // The picture has a wider aspect ratio than the card, so its left and right sides are cut off.
  const float cut = (1 - rect.width() / rect.height() / 1.5f) / 2;
  ImGui::GetWindowDrawList()->AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                                              im(rect.low), im(rect.high), {cut, 0}, {1 - cut, 1}, 0xFFFFFFFF,
                                              look.px(4));
}

// Handles a press on a card: a click applies the pose, a sideways drag blends towards the pose, and Escape cancels.
//   name  the pose's name in TransformSettings::library_pose
void take_press(Context& context, const NamedPose& pose, const std::string& name, const Pressed& pressed) {
  auto& drag = context.transform_settings->library_drag;
  if (pressed.activated) {
    context.transform_settings->library_pose = name;
    drag = {name, context.ui->input.pointer.x, false};
  }
  if (drag.pose != name) return;
  const double way = context.ui->input.pointer.x - drag.begin, scale = context.ui->look.scale,
               share = std::clamp(way / (kPixels * scale), 0.0, 1.0);
  if (context.ui->input.down(Key::Escape)) {
    drag = {};
    drop_shown_pose(context);
    return;
  }
  if (pressed.held) {
    drag.moved = drag.moved || std::abs(way) >= kFirstPixels * scale;
    if (drag.moved) preview_pose(context, on_the_way_to(context, pose, share), set_on_the_way(context, share));
    return;
  }
  const bool moved = drag.moved;
  drag = {};
  const NamedPose named = pose;  // copied, because apply_pose() replaces the document
  if (moved) apply_pose(context, named, share);
  else if (pressed.clicked) apply_pose(context, named, 1);
}

// Draws the card of a pose.
//   description  description of a built-in pose; "": a pose of the user
void draw_card(Context& context, const NamedPose& pose, const Rect& rect, std::string_view description = "") {
  const Look& look = context.ui->look;
  const Rect picture{rect.low, {rect.high.x, rect.low.y + look.px(kPicture)}};
  const std::string name = description.empty() ? pose.name : library_name(pose);
  const bool chosen = context.transform_settings->library_pose == name;
  const Pressed pressed = press_area(context.ui, description.empty() ? pose.name : "Body pose " + pose.name, rect);
  draw_picture(context, pose, picture);
  const float width = chosen ? 2 * look.line() : look.line();
  ImGui::GetWindowDrawList()->AddRect(im(picture.low), im(picture.high),
                                      chosen            ? look.theme.select
                                      : pressed.hovered ? look.theme.text2
                                                        : look.theme.line2,
                                      look.px(4), 0, width);
  const auto& drag = context.transform_settings->library_drag;
  if (drag.pose == name && drag.moved) {
    const float share =
        std::clamp((context.ui->input.pointer.x - drag.begin) / static_cast<float>(kPixels * look.scale), 0.0f, 1.0f);
    fill({{picture.low.x, picture.high.y - look.px(4)}, {picture.low.x + share * picture.width(), picture.high.y}},
         look.theme.select, look.px(2));
  }
  put_text(context.ui, look.fonts.small, chosen ? look.theme.text : look.theme.text2,
           Rect{{rect.low.x, picture.high.y}, rect.high}, pose.name, Align::Centre);
  const std::string use =
      "Click to apply the pose to the selected bones, or to all. Drag sideways to blend towards it.";
  if (pressed.hovered && !pressed.held)
    tooltip(context.ui, rect, pose.name, description.empty() ? use : std::string(description) + " " + use);
  if (pressed.right_clicked) {
    context.transform_settings->library_pose = name;
    context.menus->open_popup = "Pose library";
  }
  take_press(context, pose, name, pressed);
}

// Draws the cards of the poses in rows.
//   describe  called with a pose's index in the library; returns the pose's description
template <class Describe>
void draw_cards(Context& context, Column& column, const PoseLibrary& library, const Describe& describe) {
  const Look& look = context.ui->look;
  for (std::size_t first = 0; first < library.size(); first += kAcross) {
    const Rect row = column.row(kPicture + kWords + 4);
    const float gap = look.px(8), left = row.low.x + look.px(10),
                width = (row.width() - look.px(20) - (kAcross - 1) * gap) / kAcross;
    for (std::size_t i = first; i < std::min(first + kAcross, library.size()); ++i) {
      const float x = std::round(left + static_cast<float>(i - first) * (width + gap));
      draw_card(context, *library[i], {{x, row.low.y}, {std::round(x + width), row.low.y + look.px(kPicture + kWords)}},
                describe(i));
    }
  }
}

void draw_body_poses(Context& context, Column& column) {
  const PoseLibrary cards = pictured_body_pose_cards(context);
  if (cards.empty()) return;
  const Rect words = column.row(kWords);
  put_text(context.ui, context.ui->look.fonts.small, context.ui->look.theme.text2,
           {{words.low.x + context.ui->look.px(10), words.low.y}, words.high}, "For any body");
  draw_cards(context, column, cards, [&](std::size_t i) { return require_body_pose(cards[i]->name, "").description; });
}

}  // namespace

void draw_pose_library(Context& context, Column& column) {
  if (!context.document().armature) return;
  const Look& look = context.ui->look;
  const bool open = column.begin_section("Pose library", "", false);
  const Rect head = column.head();
  operator_button(
      context, "pose.library_add",
      {{head.high.x - look.px(34), head.low.y + look.px(2)}, {head.high.x - look.px(6), head.high.y - look.px(2)}}, "");
  if (open) {
    const PoseLibrary library = context.document().poses;
    column.space(8);
    if (library.empty()) {
      const Operator* op = find_operator(context.operators, "pose.library_add");
      if (empty_state(context.ui, column.row(72), "No poses yet", op->label)) run(context, *op);
    }
    draw_cards(context, column, library, [](std::size_t) { return std::string_view(); });
    draw_body_poses(context, column);
    column.space(4);
  }
  column.end_section();
}

}  // namespace limber::editor
