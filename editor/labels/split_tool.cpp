// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/labels/split_tool.h"

#include "core/label_edit/split_label.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/labels/label_edits.h"
#include "editor/ui/draw.h"
#include "editor/viewport/gizmo_draw.h"
#include "editor/viewport/transform_tool.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

constexpr double kLeast = 4;  // a shorter line is ignored as a slip of the hand, pixels at scale 1

class SplitTool final : public Modal {
 public:
  explicit SplitTool(Context& context)
      : pointer_(context.ui->input.pointer),
        name_(shown_name(edited_tissue(context))) {}

  bool moved(Context& context, const glm::vec2&) override {
    pointer_ = context.ui->input.pointer;
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
      begun_ = pointer_;
      return true;
    }
    if (!view_) return true;
    if (glm::distance(begun_, pointer_) >= kLeast * context.ui->look.scale)
      attempt(context, title(), [this](Context& c) { split(c); });
    return false;
  }

  void draw(Context& context, const ViewPlace& place) override {
    if (!view_ || place.id != view_->place.id) return;
    ImDrawList& canvas = *ImGui::GetWindowDrawList();
    const float line = 2 * context.ui->look.scale;
    canvas.AddLine(im(begun_), im(pointer_), with_alpha(0xFF000000, 0.55f), 2 * line);
    canvas.AddLine(im(begun_), im(pointer_), context.ui->look.theme.select, line);
    for (const glm::vec2& end : {begun_, pointer_}) {
      canvas.AddCircleFilled(im(end), 2.2f * line, with_alpha(0xFF000000, 0.55f));
      canvas.AddCircleFilled(im(end), 1.6f * line, context.ui->look.theme.select);
    }
  }

  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"LMB"}, "Draw a line across the tissue"}, {{"Esc"}, "Cancel"}};
  }
  std::string title() const override { return "Split " + name_; }

 private:
  void split(Context& context) {
    if (!needs_edited_tissue(context).empty()) return;
    // In the 3D view, the cut lies in the plane through the line and the eye; its width is measured at the depth of the
    // camera's centre.
    const glm::dvec3 depth =
        view_->place.id == ViewId::Body ? context.views->body.camera.centre : context.views->cross_hair;
    const auto from = view_->in_plane(begun_, depth, view_->towards_eye),
               to = view_->in_plane(pointer_, depth, view_->towards_eye);
    if (!from || !to) return;
    const LabelCut cut{*from, *to, view_->direction_to_eye((*from + *to) / 2.0)};
    const Tissue tissue = edited_tissue(context);
    const Tissue part = new_tissue_like(*context.document().tissues, &tissue);
    start_label_edit(context, {"Split " + shown_name(tissue),
                               [cut, label = tissue.label, into = part.label, name = shown_name(part)](
                                   const LabelVolume& volume, Progress&) -> FoundLabelEdit {
                                 LabelChange change = split_label(volume, label, cut, into);
                                 const std::string note = "The smaller part is now " + name;
                                 return {std::move(change), note};
                               },
                               with_tissue(*context.document().tissues, part), part.label});
  }

  glm::vec2 pointer_, begun_{0};
  std::string name_;                    // name of the tissue that is split
  std::optional<ViewProjection> view_;  // the view in which the line is drawn; none until the button is pressed
};

}  // namespace

std::unique_ptr<Modal> begin_split(Context& context) { return std::make_unique<SplitTool>(context); }

}  // namespace limber::editor
