// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/grey_image_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <glm/gtc/constants.hpp>

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/dialogs/dialog.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/texture_cache.h"
#include "render/view.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 980, kHeight = 690, kGap = 8;
constexpr const char* kNames[] = {"Axial", "Coronal", "Sagittal", "Maximum intensity, drag to turn"};
constexpr int kProjection = 3;

class GreyImageDialog final : public Dialog {
 public:
  explicit GreyImageDialog(ShownImage shown) : shown_(std::move(shown)), window_(usual_window(*shown_.image)) {
    const Grid& grid = shown_.image->grid;
    middle_ = world_from_voxel(grid) * (0.5 * (glm::dvec3(grid.size) - 1.0));
    cross_ = middle_;
    for (int axis = 0; axis < 3; ++axis)
      sides_ += glm::abs(world_from_voxel(grid).linear[axis]) * double(grid.size[axis]);
    const auto [low, high] = std::minmax_element(shown_.image->voxels.begin(), shown_.image->voxels.end());
    if (low != shown_.image->voxels.end()) least_ = *low, most_ = *high;
  }

  void draw(Context& context) override {
    const Look& look = context.ui->look;
    const Rect rect = begin_dialog(context, shown_.name + " is a grey image", kWidth, kHeight);
    const std::string words = "A grey image, not labels: " + shown_.doubt +
                              ". Shown as an image, it lies below the tissues and moves with the pose; rigs, weights "
                              "and poses need the label volume that was segmented from it.";
    const float text = put_wrapped(context.ui, look.fonts.regular, look.theme.text, rect.low, rect.width(), words);
    const float foot = rect.high.y - look.px(28), top = rect.low.y + text + look.px(10);
    const float gap = look.px(kGap);
    const glm::vec2 pane{std::floor((rect.width() - gap) / 2), std::floor((foot - look.px(12) - top - gap) / 2)};
    for (int p = 0; p < 4; ++p) {
      const glm::vec2 low = glm::round(glm::vec2(rect.low.x, top) + glm::vec2(p % 2, p / 2) * (pane + gap));
      draw_pane(context, p, {low, low + pane});
    }
    draw_foot(context, {{rect.low.x, foot}, rect.high});
    end_dialog(context);
  }

 private:
  // The inputs from which a pane's texture was made. The texture is made again when one of them changes.
  struct Pane {
    GreyFrame frame;
    GreyWindow window;
    std::vector<float> values;
    bool made = false;
  };

  GreyFrame frame_of_pane(int p, const glm::vec2& size) const {
    GreyFrame frame;
    if (p == kProjection) {
      frame.right = {std::cos(turn_), std::sin(turn_), 0};
      frame.down = {0, 0, -1};
    } else {
      const render::SliceFrame axes = render::frame_of(kAxes[p]);
      frame.right = axes.right;
      frame.down = axes.down;
    }
    // The projection casts a ray for every pixel, which takes longer than drawing a slice. Therefore the projection has
    // half as many pixels in x and in y.
    const int coarser = p == kProjection ? 2 : 1;
    frame.size = glm::max(glm::ivec2(size) / coarser, 1);
    const double wide = p == kProjection ? std::hypot(sides_.x, sides_.y) : glm::dot(glm::abs(frame.right), sides_);
    const double high = glm::dot(glm::abs(frame.down), sides_);
    frame.millimetres_per_pixel = std::max({wide / frame.size.x, high / frame.size.y, 1e-6});
    const glm::dvec3 normal = glm::cross(frame.right, frame.down);
    frame.middle = middle_ + (p == kProjection ? glm::dvec3(0) : normal * glm::dot(cross_ - middle_, normal));
    return frame;
  }

  static bool same(const GreyFrame& a, const GreyFrame& b) {
    return a.middle == b.middle && a.right == b.right && a.down == b.down && a.size == b.size &&
           a.millimetres_per_pixel == b.millimetres_per_pixel;
  }

  unsigned texture_of(Context& context, int p, const GreyFrame& frame) {
    Pane& pane = panes_[static_cast<std::size_t>(p)];
    const std::string name = "grey image " + std::to_string(p);
    const bool moved = !pane.made || !same(pane.frame, frame);
    const GreyVolume& image = *shown_.image;
    if (moved) pane.values = p == kProjection ? grey_projection(image, frame) : grey_slice(image, frame);
    if (moved || pane.window != window_) context.pictures->forget(name);
    pane.frame = frame;
    pane.window = window_;
    pane.made = true;
    return context.pictures->texture(name, [&] {
      render::Image picture{frame.size, {}};
      picture.rgba.reserve(4 * pane.values.size());
      for (const float value : pane.values) {
        const std::uint8_t grey = grey_of(value, window_);
        picture.rgba.insert(picture.rgba.end(), {grey, grey, grey, 255});
      }
      return picture;
    });
  }

  void draw_pane(Context& context, int p, const Rect& rect) {
    const Look& look = context.ui->look;
    const Pressed pressed = press_area(context.ui, kNames[p], rect);
    const GreyFrame before = frame_of_pane(p, rect.size());
    move(context, p, rect, before, pressed);
    const GreyFrame frame = frame_of_pane(p, rect.size());
    fill(rect, 0xFF000000);
    if (const unsigned texture = texture_of(context, p, frame))
      ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                                           im(rect.low), im(rect.high));
    if (p != kProjection) draw_cross(context, rect, frame);
    outline(rect, look.theme.line2, 0, look.line());
    put_text(context.ui, look.fonts.small, 0xFFFFFFFF, rect.low + look.px(6), kNames[p]);
  }

  // Handles the pointer over a pane. In a slice, a press moves the cross-hair and the wheel steps through the slices.
  // In the projection, a drag turns the view of the image.
  void move(Context& context, int p, const Rect& rect, const GreyFrame& frame, const Pressed& pressed) {
    const ImGuiIO& io = ImGui::GetIO();
    if (p == kProjection) {
      if (!pressed.held || io.MouseDelta.x == 0) return;
      turn_ += double(io.MouseDelta.x) / double(rect.width()) * glm::pi<double>();
      return context.ui->touch();
    }
    const glm::dvec3 normal = glm::cross(frame.right, frame.down);
    if (pressed.held) {
      const glm::dvec2 at = glm::dvec2(from_im(io.MousePos) - rect.centre()) * frame.millimetres_per_pixel;
      put_cross(context, frame.middle + frame.right * at.x + frame.down * at.y);
    } else if (pressed.hovered && io.MouseWheel != 0) {
      const glm::dvec3 across = glm::abs(voxel_from_world(shown_.image->grid).linear * normal);
      put_cross(context, cross_ + normal * (double(io.MouseWheel) / std::max({across.x, across.y, across.z})));
    }
  }

  // Moves the cross-hair to a world point, or to the nearest point of the volume if the point lies outside.
  void put_cross(Context& context, const glm::dvec3& world) {
    const Grid& grid = shown_.image->grid;
    const glm::dvec3 voxel = voxel_from_world(grid) * world;
    const glm::dvec3 next = world_from_voxel(grid) * glm::clamp(voxel, glm::dvec3(0), glm::dvec3(grid.size - 1));
    if (glm::distance(next, cross_) < 1e-9) return;
    cross_ = next;
    context.ui->touch();
  }

  void draw_cross(Context& context, const Rect& rect, const GreyFrame& frame) {
    const glm::dvec3 off = (cross_ - frame.middle) / frame.millimetres_per_pixel;
    const glm::vec2 at = rect.centre() + glm::vec2(glm::dot(off, frame.right), glm::dot(off, frame.down));
    ImDrawList& canvas = *ImGui::GetWindowDrawList();
    const Colour colour = with_alpha(context.ui->look.theme.accent, 0.6f);
    canvas.AddLine(im({rect.low.x, at.y}), im({rect.high.x, at.y}), colour);
    canvas.AddLine(im({at.x, rect.low.y}), im({at.x, rect.high.y}), colour);
  }

  std::string value_at_cross() const {
    const Grid& grid = shown_.image->grid;
    const glm::ivec3 voxel(glm::floor(voxel_from_world(grid) * cross_ + 0.5));
    if (!grid.contains(voxel)) return "";
    char text[120];
    std::snprintf(text, sizeof text, "%.1f, %.1f, %.1f mm: %g", cross_.x, cross_.y, cross_.z,
                  double(shown_.image->voxels[static_cast<std::size_t>(grid.index(voxel))]));
    return text;
  }

  void draw_foot(Context& context, const Rect& rect) {
    const Look& look = context.ui->look;
    bool committed = false;
    float x = rect.low.x;
    const auto number = [&](const char* name, double& value, double low, double high) {
      const Rect label{{x, rect.low.y}, {x + look.px(46), rect.high.y}};
      put_text(context.ui, look.fonts.regular, look.theme.text2, label, name);
      const Rect field{{x + look.px(48), rect.low.y + look.px(3)}, {x + look.px(138), rect.high.y - look.px(3)}};
      if (number_field(context.ui, name, field, value, low, high, "%.4g", "", false, committed)) context.ui->touch();
      x = field.high.x + look.px(14);
    };
    const double range = std::max(most_ - least_, 1e-3);
    number("Level", window_.level, least_ - range, most_ + range);
    number("Width", window_.width, 1e-3 * range, 2 * range);
    const ButtonLook show{"", "Show as image", ButtonStyle::Primary}, close{"", "Close", ButtonStyle::Plain},
        labels{"", shown_.answer, ButtonStyle::Plain};
    float right = rect.high.x;
    const auto press = [&](const std::string& name, const ButtonLook& face) {
      const float width = std::max(width_of_button(context.ui, face) + look.px(8), look.px(80));
      const Rect place{{right - width, rect.low.y}, {right, rect.high.y}};
      right = place.low.x - look.px(8);
      return button(context.ui, name, place, face);
    };
    const bool shows = press("Show as image", show), closes = press("Close image", close),
               takes = press(shown_.answer, labels);
    put_text(context.ui, look.fonts.mono, look.theme.text2, Rect{{x, rect.low.y}, {right, rect.high.y}},
             value_at_cross());
    if (!shows && !closes && !takes) return;
    const auto act = takes ? shown_.as_labels : shows ? shown_.as_image : nullptr;
    context.dialogs->close();
    context.ui->touch();
    if (act) attempt(context, shown_.name, act);
  }

  static constexpr render::SliceAxis kAxes[] = {render::SliceAxis::Axial, render::SliceAxis::Coronal,
                                                render::SliceAxis::Sagittal};
  ShownImage shown_;
  GreyWindow window_;
  glm::dvec3 middle_{0}, cross_{0};  // centre of the image, and position of the cross-hair; world, mm
  glm::dvec3 sides_{0};              // size of the image's bounding box in the world, mm
  double least_ = 0, most_ = 1, turn_ = 0;
  std::array<Pane, 4> panes_;
};

}  // namespace

void show_grey_image(Context& context, ShownImage shown) {
  context.dialogs->open(std::make_unique<GreyImageDialog>(std::move(shown)));
  context.ui->touch();
}

}  // namespace limber::editor
