// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/labels/split_tool.h"

#include "core/label_edit/split_label.h"
#include "editor/context/operator.h"
#include "editor/context/view_projection.h"
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
  explicit SplitTool(Editor& editor) : pointer_(editor.input.pointer), name_(shown_name(edited_tissue(editor))) {}

  bool moved(Editor& editor, const glm::vec2&) override {
    pointer_ = editor.input.pointer;
    editor.touch();
    return true;
  }
  bool key(Editor&, const KeyChanged& event) override { return !(event.down && event.key == Key::Escape); }
  bool button(Editor& editor, const ButtonChanged& event) override {
    if (event.button == MouseButton::Right && event.down) return false;
    if (event.button != MouseButton::Left) return true;
    if (event.down) {
      const ViewPlace* place = editor.layout.view_at(pointer_);
      if (!place) return false;
      view_.emplace(editor, *place);
      begun_ = pointer_;
      return true;
    }
    if (!view_) return true;
    if (glm::distance(begun_, pointer_) >= kLeast * editor.look.scale)
      attempt(editor, title(), [this](Editor& e) { split(e); });
    return false;
  }

  void draw(Editor& editor, const ViewPlace& place) override {
    if (!view_ || place.id != view_->place.id) return;
    ImDrawList& canvas = *ImGui::GetWindowDrawList();
    const float line = 2 * editor.look.scale;
    canvas.AddLine(im(begun_), im(pointer_), with_alpha(0xFF000000, 0.55f), 2 * line);
    canvas.AddLine(im(begun_), im(pointer_), editor.look.theme.select, line);
    for (const glm::vec2& end : {begun_, pointer_}) {
      canvas.AddCircleFilled(im(end), 2.2f * line, with_alpha(0xFF000000, 0.55f));
      canvas.AddCircleFilled(im(end), 1.6f * line, editor.look.theme.select);
    }
  }

  std::vector<KeyHint> hints(const Editor&) const override {
    return {{{"LMB"}, "Draw a line across the tissue"}, {{"Esc"}, "Cancel"}};
  }
  std::string title() const override { return "Split " + name_; }

 private:
  void split(Editor& editor) {
    if (!needs_edited_tissue(editor).empty()) return;
    // In the 3D view, the cut lies in the plane through the line and the eye; its width is measured at the depth of the
    // camera's centre.
    const glm::dvec3 depth =
        view_->place.id == ViewId::Body ? editor.views->body.camera.centre : editor.views->cross_hair;
    const auto from = view_->in_plane(begun_, depth, view_->towards_eye),
               to = view_->in_plane(pointer_, depth, view_->towards_eye);
    if (!from || !to) return;
    const LabelCut cut{*from, *to, view_->direction_to_eye((*from + *to) / 2.0)};
    const Tissue tissue = edited_tissue(editor);
    const Tissue part = new_tissue_like(*editor.document().tissues, &tissue);
    start_label_edit(editor, {"Split " + shown_name(tissue),
                              [cut, label = tissue.label, into = part.label, name = shown_name(part)](
                                  const LabelVolume& volume, Progress&) -> FoundLabelEdit {
                                LabelChange change = split_label(volume, label, cut, into);
                                const std::string note = "The smaller part is now " + name;
                                return {std::move(change), note};
                              },
                              with_tissue(*editor.document().tissues, part), part.label});
  }

  glm::vec2 pointer_, begun_{0};
  std::string name_;                    // name of the tissue that is split
  std::optional<ViewProjection> view_;  // the view in which the line is drawn; none until the button is pressed
};

}  // namespace

std::unique_ptr<Modal> begin_split(Editor& editor) { return std::make_unique<SplitTool>(editor); }

}  // namespace limber::editor
