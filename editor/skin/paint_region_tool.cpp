// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/view_projection.h"
#include "editor/skin/paint_region.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/draw.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

namespace {

constexpr float kStep = 2;        // the lasso gets a new point when the pointer has moved this far, pixels
constexpr double kLeastArea = 4;  // a smaller outline is ignored as a slip of the hand, square pixels

// The pixels of a view that lie inside an outline (even-odd rule), stored as one byte per pixel. With this table, each
// of millions of voxels is tested in constant time.
class Stencil {
 public:
  Stencil(const Rect& view, const std::vector<glm::dvec2>& outline)
      : low_(view.low),
        size_(glm::ivec2(glm::ceil(view.size()))),
        inside_(static_cast<std::size_t>(size_.x) * size_.y, 0) {
    std::vector<double> crossings;
    for (int y = 0; y < size_.y; ++y) {
      const double row = low_.y + y + 0.5;
      crossings.clear();
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
        if ((a.y <= row) != (b.y <= row)) crossings.push_back(a.x + (row - a.y) / (b.y - a.y) * (b.x - a.x));
      }
      std::sort(crossings.begin(), crossings.end());
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const int from = std::max(0, static_cast<int>(std::ceil(crossings[i] - low_.x - 0.5))),
                  to = std::min(size_.x, static_cast<int>(std::ceil(crossings[i + 1] - low_.x - 0.5)));
        for (int x = from; x < to; ++x) inside_[static_cast<std::size_t>(y) * size_.x + x] = 1;
      }
    }
  }

  bool holds(const glm::dvec2& pixel) const {
    const glm::ivec2 at(glm::floor(pixel - low_));
    return at.x >= 0 && at.y >= 0 && at.x < size_.x && at.y < size_.y &&
           inside_[static_cast<std::size_t>(at.y) * size_.x + at.x];
  }

 private:
  glm::dvec2 low_;
  glm::ivec2 size_;
  std::vector<std::uint8_t> inside_;
};

double area_of(const std::vector<glm::dvec2>& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return std::abs(twice) / 2;
}

RegionChange change_of(const Ui& ui) {
  const bool shift = ui.input.down(Key::Shift), ctrl = ui.input.down(Key::Ctrl);
  return shift && ctrl ? RegionChange::Common
         : shift       ? RegionChange::Add
         : ctrl        ? RegionChange::TakeOut
                       : RegionChange::Replace;
}

class RegionTool final : public Modal {
 public:
  RegionTool(Context& context, bool lasso) : lasso_(lasso), pointer_(context.ui->input.pointer) {}

  bool moved(Context& context, const glm::vec2&) override {
    pointer_ = context.ui->input.pointer;
    if (view_ && lasso_ && glm::distance(outline_.back(), glm::dvec2(pointer_)) >= kStep) outline_.push_back(pointer_);
    context.ui->touch();
    return true;
  }
  bool key(Context&, const KeyChanged& event) override { return !(event.down && event.key == Key::Escape); }
  bool button(Context& context, const ButtonChanged& event) override {
    if (event.button == MouseButton::Right && event.down) return false;
    if (event.button != MouseButton::Left) return true;
    if (event.down) {
      const ViewPlace* place = context.screen->layout.view_at(pointer_);
      if (!place) return false;
      view_.emplace(context, *place);
      outline_ = {pointer_};
      return true;
    }
    if (!view_) return true;
    keep(context);
    return false;
  }

  void draw(Context& context, const ViewPlace& place) override {
    const Theme& theme = context.ui->look.theme;
    const Colour line = theme.view_text;
    if (!view_) {
      if (!place.rect.contains(pointer_)) return;
      fill({{place.rect.low.x, pointer_.y}, {place.rect.high.x, pointer_.y + context.ui->look.line()}},
           with_alpha(line, 0.5f));
      fill({{pointer_.x, place.rect.low.y}, {pointer_.x + context.ui->look.line(), place.rect.high.y}},
           with_alpha(line, 0.5f));
      return;
    }
    if (place.id != view_->place.id) return;
    if (!lasso_) {
      const Rect box{glm::min(glm::vec2(outline_[0]), pointer_), glm::max(glm::vec2(outline_[0]), pointer_)};
      fill(box, with_alpha(line, 0.08f));
      outline(box, line, 0, context.ui->look.line());
      return;
    }
    std::vector<ImVec2> points;
    for (const glm::dvec2& point : outline_) points.push_back(im(glm::vec2(point)));
    points.push_back(im(pointer_));
    ImGui::GetWindowDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()), line, ImDrawFlags_Closed,
                                            1.5f * context.ui->look.line());
  }

  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"LMB"}, lasso_ ? "Draw an outline" : "Draw a box"},
            {{"Shift"}, "Add to region"},
            {{"Ctrl"}, "Subtract from region"},
            {{"Shift", "Ctrl"}, "Intersect with region"},
            {{"Esc"}, "Cancel"}};
  }
  std::string title() const override { return lasso_ ? "Region by a lasso" : "Region by a box"; }

 private:
  void keep(Context& context) {
    std::vector<glm::dvec2> outline = outline_;
    const glm::dvec2 end(pointer_);
    if (lasso_) outline.push_back(end);
    else outline = {outline[0], {end.x, outline[0].y}, end, {outline[0].x, end.y}};
    if (area_of(outline) < kLeastArea) return;
    const ViewProjection view = *view_;
    const auto stencil = std::make_shared<const Stencil>(view.place.rect, outline);
    change_region(context, lasso_ ? "Region by a lasso" : "Region by a box", change_of(context.ui),
                  [view, stencil](const WeightsToEdit& what) {
                    const AffineTransform world = world_from_voxel(what.document.volume->grid);
                    return region_where(*what.tissue, [&](std::int64_t, const glm::ivec3& voxel) {
                      const auto pixel = view.pixel_of(world * glm::dvec3(voxel));
                      return pixel && stencil->holds(*pixel);
                    });
                  });
  }

  const bool lasso_;
  glm::vec2 pointer_;
  std::optional<ViewProjection> view_;  // the view in which the outline is drawn; none until the button is pressed
  std::vector<glm::dvec2> outline_;
};

}  // namespace

std::unique_ptr<Modal> begin_region_box(Context& context) { return std::make_unique<RegionTool>(context, false); }
std::unique_ptr<Modal> begin_region_lasso(Context& context) { return std::make_unique<RegionTool>(context, true); }

}  // namespace limber::editor
