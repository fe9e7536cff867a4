// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws toasts, which are short messages at the bottom right of the 3D view, or left of or above what is drawn over the
// view there: the gizmo, legends, the scale bar, the tour's bubble, the fields of the last operation. They leave the
// limbs free, too, if there is room beside them. Infos stay 4 s, warnings 8 s, errors until the user closes them. At
// most three toasts are visible, or one if only slices are shown or if more would cover a limb; a line above the toasts
// tells how many older messages there are. While the pointer is over a toast, no toast disappears and no new toast
// appears.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/preferences.h"
#include "editor/context/screen.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/icons.h"
#include "editor/ui/severity_style.h"

namespace limber::editor {

namespace {

constexpr std::size_t kMost = 3;
constexpr float kWidth = 332, kLeast = 52, kGap = 8, kLeastPlace = 240;
constexpr int kLines = 2, kDetailLines = 3;
// The flesh around a bone is assumed to be this fraction of the bone's length thick, and at least kThinnest px at scale
// 1. A bone is covered by squares whose centres are at most kStep px at scale 1 apart.
constexpr float kFlesh = 0.2f, kThinnest = 10, kStep = 24;
constexpr double kFadeIn = 0.12, kFadeOut = 0.2;  // durations in which a toast fades in and out, s

double life_of(Severity severity) {
  return severity == Severity::Error ? 1e300 : severity == Severity::Warning ? 8 : 4;
}

// The texts of a toast (message and label of its button), with their sizes in pixels.
struct Shape {
  std::string line, action;
  float words = 0, action_width = 0;  // width of the area for the message; width of the button, 0: no button
  float line_height = 0, height = 0;
};

Shape shape_of(const Context& context, const Toast& toast, float width) {
  const Look& look = context.ui->look;
  Shape shape;
  shape.line = toast.times > 1 ? toast.line + " (" + std::to_string(toast.times) + " times)" : toast.line;
  const Operator* op = toast.action.empty() ? nullptr : find_operator(context.operators, toast.action);
  shape.action = !toast.failure.empty() ? "Details" : op ? op->label : "";
  shape.action_width = shape.action.empty() ? 0 : text_size(look.fonts.regular, shape.action).x + look.px(24);
  shape.words = width - look.px(42 + 34) - shape.action_width;
  shape.line_height = height_of_wrapped(look.fonts.regular, shape.line, shape.words, kLines);
  const float detail =
      toast.detail.empty() ? 0 : height_of_wrapped(look.fonts.small, toast.detail, shape.words, kDetailLines);
  shape.height = std::max(look.px(kLeast), std::round(shape.line_height + detail + look.px(18)));
  return shape;
}

// Returns the toast's opacity while it fades in or out, [0, 1].
float presence(Context& context, const Toast& toast) {
  if (context.preferences->reduce_motion) return 1;
  const double age = context.ui->now - toast.since, left = life_of(toast.severity) - age;
  if (age < kFadeIn || left < kFadeOut) context.ui->wake_at(context.ui->now);
  return static_cast<float>(std::clamp(std::min((age + 0.02) / kFadeIn, left / kFadeOut), 0.0, 1.0));
}

void fade(ImDrawList& canvas, int first, float presence) {
  for (int i = first; i < canvas.VtxBuffer.Size; ++i) {
    ImU32& colour = canvas.VtxBuffer[i].col;
    colour = with_alpha(colour, static_cast<float>(colour >> 24) / 255 * presence);
  }
}

// Draws a toast; returns true if the user closed it.
bool draw_toast(Context& context, const Toast& toast, const Shape& shape, const Rect& rect, int index) {
  const Look& look = context.ui->look;
  begin_region(context.ui, Region::Toast, "toast " + std::to_string(index), rect, 0);
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const int first = canvas.VtxBuffer.Size;
  const Sign sign = sign_of(look.theme, toast.severity);
  fill(rect, look.theme.panel, look.px(6));
  outline(rect, look.theme.line2, look.px(6), look.line());
  canvas.AddRectFilled(im(rect.low), {rect.low.x + look.px(3), rect.high.y}, sign.colour, look.px(6),
                       ImDrawFlags_RoundCornersLeft);
  put_icon(look.fonts.regular, sign.colour,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {rect.low.x + look.px(34), rect.high.y}}, sign.icon);

  const float left = rect.low.x + look.px(42), middle = rect.centre().y;
  const float detail =
      toast.detail.empty() ? 0 : height_of_wrapped(look.fonts.small, toast.detail, shape.words, kDetailLines);
  const float top = std::round(middle - (shape.line_height + detail) / 2);
  put_wrapped(context.ui, look.fonts.regular, look.theme.text, {left, top}, shape.words, shape.line, kLines);
  if (detail > 0)
    put_wrapped(context.ui, look.fonts.small, look.theme.text2, {left, top + shape.line_height}, shape.words,
                toast.detail, kDetailLines);
  if (!shape.action.empty()) {
    const Rect link{{left + shape.words + look.px(8), middle - look.px(12)},
                    {left + shape.words + shape.action_width, middle + look.px(12)}};
    const Operator* op = find_operator(context.operators, toast.action);
    const Pressed pressed = press_area(context.ui, shape.action, link);
    put_text(context.ui, look.fonts.regular, look.theme.accent_text, link, shape.action, Align::Centre);
    if (pressed.hovered)
      op ? operator_tooltip(context, *op, link)
         : tooltip(context.ui, link, "Details", "Show the full message, which says what to do.");
    if (pressed.clicked) op ? run(context, *op) : context.messages->show_again(toast.failure);
  }
  const Rect close{{rect.high.x - look.px(30), middle - look.px(12)}, {rect.high.x - look.px(6), middle + look.px(12)}};
  register_widget(context.ui, "box", rect);
  const bool closed = button(context.ui, "Close message", close, {icon::kClose, "", ButtonStyle::Flat});
  fade(canvas, first, presence(context, toast));
  end_region(context.ui);
  return closed;
}

// Draws the number of older messages that are not shown as toasts. A click on the number opens the console.
void draw_more(Context& context, std::size_t count, float bottom, float right) {
  const Look& look = context.ui->look;
  const std::string words = "+" + std::to_string(count) + " more";
  const float width = text_size(look.fonts.small, words).x + look.px(20);
  const Rect rect{{right - width, bottom - look.px(22)}, {right, bottom}};
  begin_region(context.ui, Region::Toast, "toasts", rect, 0);
  const Pressed pressed = press_area(context.ui, "more", rect);
  fill(rect, pressed.hovered ? look.theme.hover : look.theme.panel, look.px(5));
  outline(rect, look.theme.line2, look.px(5), look.line());
  put_text(context.ui, look.fonts.small, look.theme.text2, rect, words, Align::Centre);
  if (pressed.hovered) tooltip(context.ui, rect, "Older messages", "Open the console, which lists all messages.");
  if (pressed.clicked) {
    context.messages->toasts.clear();
    if (!context.screen->arrangement().console) run(context, "view.console");
  }
  end_region(context.ui);
}

// Returns the area for toasts: the 3D view, or all views if no 3D view is shown.
Rect place_of_toasts(const Context& context) {
  const Layout& layout = context.screen->layout;
  Rect place = layout.views;
  for (const ViewPlace& view : layout.view_places)
    if (view.id == ViewId::Body && !view.side_a && view.rect.width() >= context.ui->look.px(kLeastPlace))
      place = view.rect;
  return layout.uncovered(place);
}

// Returns true if the pointer is over a toast, at the position where the toast was drawn in the last frame.
bool points_at_toasts(const Ui& ui) {
  const auto& widgets = ui.widgets.widgets();
  return std::any_of(widgets.begin(), widgets.end(), [&](const Widget& widget) {
    return widget.region == Region::Toast && widget.name.starts_with("toast") && widget.rect.contains(ui.input.pointer);
  });
}

// The rectangles that toasts should not cover. If there is no free room outside all of them, toasts stay clear of only
// `rects`, and if this is impossible, too, of only the first `needed` of them, which contain controls that the user may
// need meanwhile.
struct Kept {
  std::vector<Rect> rects;
  std::size_t needed = 0;
  std::vector<Rect> limbs;  // squares that cover the bones of the 3D view and the flesh around them
};

void add_limbs(const Context& context, const ViewProjection& view, std::vector<Rect>& limbs) {
  const render::Scene& scene = context.views->scene;
  if (!scene.armature) return;
  const Look& look = context.ui->look;
  for (std::size_t b = 0; b < scene.armature->bones.size(); ++b) {
    const Bone& bone = scene.armature->bones[b];
    const RigidTransform posed = b < scene.posed_from_rest.size() ? scene.posed_from_rest[b] : RigidTransform{};
    const auto head = view.pixel_of(posed * bone.head), tail = view.pixel_of(posed * bone.tail);
    if (!head || !tail) continue;
    const auto length = static_cast<float>(glm::distance(*head, *tail));
    const float thickness = std::max(kFlesh * length, look.px(kThinnest));
    const int steps = std::clamp(static_cast<int>(std::ceil(length / look.px(kStep))), 1, 64);
    for (int i = 0; i <= steps; ++i) {
      const glm::vec2 centre = glm::mix(*head, *tail, static_cast<double>(i) / steps);
      const Rect square = Rect{centre, centre}.grown(thickness);
      if (square.overlaps(view.place.rect)) limbs.push_back(square);
    }
  }
}

Kept kept_rects(const Context& context) {
  Kept kept;
  const float gap = context.ui->look.px(kGap);
  const auto add = [&](const auto& is_kept) {
    for (const Widget& widget : context.ui->widgets.widgets())
      if (is_kept(std::string_view(widget.name))) kept.rects.push_back(widget.rect.grown(gap));
  };
  add([](std::string_view name) { return name == "tour/box" || name.ends_with("last operation/box"); });
  kept.needed = kept.rects.size();
  add([](std::string_view name) {
    return name.ends_with("/legend") || name.ends_with("/scale bar") || name.starts_with("3D view/axis ");
  });
  for (const ViewPlace& place : context.screen->layout.view_places)
    if (place.id == ViewId::Body && !place.side_a) {
      const ViewProjection view(context, place);
      if (const auto gizmo = gizmo_rect(context, view)) kept.rects.push_back(gizmo->grown(gap));
      add_limbs(context, view, kept.limbs);
    }
  return kept;
}

bool is_free(const Rect& rect, std::span<const Rect> kept) {
  return std::none_of(kept.begin(), kept.end(), [&](const Rect& one) { return rect.overlaps(one); });
}

// Returns the free rectangle of this size that is nearest to the area's lower right corner. It stands at the right, in
// the middle or at the left of the area.
std::optional<Rect> free_rect(const Rect& area, const glm::vec2& size, std::span<const Rect> kept) {
  std::optional<Rect> best;
  float least = 0;
  for (const float right : {area.high.x, std::round(area.centre().x + size.x / 2), area.low.x + size.x}) {
    std::vector<float> bottoms{area.high.y};
    for (const Rect& one : kept)
      if (one.low.y <= area.high.y && one.low.y - size.y >= area.low.y) bottoms.push_back(one.low.y);
    for (const float bottom : bottoms) {
      const Rect rect{{right - size.x, bottom - size.y}, {right, bottom}};
      const float way = 0.5f * (area.high.x - right) + area.high.y - bottom;
      if ((best && way >= least) || !is_free(rect, kept)) continue;
      best = rect;
      least = way;
    }
  }
  return best;
}

// Returns the rectangle of the lowest toast. The toast keeps its position of the last frame while it covers nothing
// there, so that it does not jump while the gizmo moves.
Rect place_of_lowest(const Ui& ui, const Rect& area, const glm::vec2& size, const Kept& kept, bool held) {
  if (const Widget* before = ui.widgets.find("toast 0/box")) {
    const Rect rect{before->rect.high - size, before->rect.high};
    const bool is_column =
        rect.high.x == area.high.x || rect.low.x == area.low.x || std::abs(rect.centre().x - area.centre().x) < 1;
    if (held || (is_column && area.contains(rect) && is_free(rect, kept.rects))) return rect;
  }
  std::vector<Rect> all = kept.rects;
  all.insert(all.end(), kept.limbs.begin(), kept.limbs.end());
  if (const auto rect = free_rect(area, size, all)) return *rect;
  if (const auto rect = free_rect(area, size, kept.rects)) return *rect;
  return free_rect(area, size, std::span(kept.rects).first(kept.needed)).value_or(Rect{area.high - size, area.high});
}

}  // namespace

void draw_toasts(Context& context) {
  auto& toasts = context.messages->toasts;
  const Look& look = context.ui->look;
  const bool held = points_at_toasts(context.ui);
  for (Toast& toast : toasts) {
    // While the pointer is over a toast, new messages wait. A message that is repeated does not wait, because its toast
    // is visible already.
    if (toast.since < 0 && (!held || toast.times > 1)) toast.since = context.ui->now;
    if (held && toast.since >= 0) toast.since = std::max(toast.since, context.ui->now - kFadeIn);
  }
  std::erase_if(toasts, [&](const Toast& toast) {
    return toast.since >= 0 && context.ui->now - toast.since >= life_of(toast.severity);
  });
  std::vector<std::size_t> seen;  // indices of the visible toasts, newest first
  for (std::size_t at = toasts.size(); at-- > 0;)
    if (toasts[at].since >= 0) seen.push_back(at);

  const Rect views = place_of_toasts(context), area = views.grown(-look.px(12));
  const float width = std::min(look.px(kWidth), area.width());
  const Kept kept = kept_rects(context);
  float bottom = area.high.y, right = area.high.x;
  std::size_t closed = toasts.size();
  const std::size_t most = std::min(seen.size(), context.screen->layout.place_of(ViewId::Body) ? kMost : 1);
  std::size_t shown = 0;
  for (; shown < most && (shown == 0 || bottom > views.centre().y); ++shown) {
    const std::size_t at = seen[shown];
    const Toast toast = toasts[at];  // a copy, because a button of this toast may add toasts to the list
    const Shape shape = shape_of(context, toast, width);
    Rect rect{{right - width, bottom - shape.height}, {right, bottom}};
    if (shown == 0) rect = place_of_lowest(context.ui, area, rect.size(), kept, held);
    else if (!is_free(rect, kept.rects) || !is_free(rect, kept.limbs)) break;
    const std::size_t count = toasts.size();
    const bool closes = draw_toast(context, toast, shape, rect, static_cast<int>(shown));
    // Stop drawing, because the toast's button has changed the list.
    if (toasts.size() != count || toasts[at].line != toast.line) return;
    if (closes) closed = at;
    if (life_of(toast.severity) < 1e9) context.ui->wake_at(toast.since + life_of(toast.severity) - kFadeOut);
    bottom = rect.low.y - look.px(kGap);
    right = rect.high.x;
  }
  if (closed < toasts.size()) toasts.erase(toasts.begin() + static_cast<std::ptrdiff_t>(closed));
  else if (seen.size() > shown) draw_more(context, seen.size() - shown, bottom, right);
}

}  // namespace limber::editor
