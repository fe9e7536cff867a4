// SPDX-License-Identifier: AGPL-3.0-or-later
// The active bone: name, parent, where its ends lie, length and roll.
#include "editor/fields.h"
#include "editor/panels/panels.h"
#include "editor/rigging.h"

namespace limber::editor {

namespace {

constexpr double kFar = 1e5;  // mm: as far as an end can be put

// A number of the bone; the rig follows while it changes and is committed once, at the end.
template <class Change>
void draw_number(Editor& editor, const Rect& rect, const std::string& name, const std::string& label, double shown, double low, double high, const char* format, const char* unit, int bone, const Change& change) {
  auto& edited = editor.edited_number;
  double value = edited.name == name ? edited.value : shown;
  bool committed = false;
  const std::shared_ptr<const Armature> rig = editor.document().armature;
  const auto with = [&](double number) { return mirrored_too(editor, change(*rig, number)); };
  if (number_field(editor, name, rect, value, low, high, format, unit, false, committed)) {
    edited = {name, value};
    show_rig(editor, with(value));
  }
  if (!committed || edited.name != name) return;
  const double number = edited.value;
  edited = {};
  commit_rig(editor, label, with(number), {bone});
}

void draw_end(Editor& editor, Column& column, const Bone& bone, const BoneEnd& end) {
  const Look& look = editor.look;
  const std::string which = end.tail ? "Tail" : "Head";
  const Rect rect = column.property(which + ", mm");
  const glm::dvec3 place = end.tail ? bone.tail : bone.head;
  const float width = (rect.width() - 2 * look.px(4)) / 3;
  for (int axis = 0; axis < 3; ++axis) {
    const float x = std::round(rect.low.x + static_cast<float>(axis) * (width + look.px(4)));
    const Rect field{{x, rect.low.y}, {std::round(x + width), rect.high.y}};
    draw_number(editor, {{field.low.x + look.px(3), field.low.y}, field.high}, which + " " + "XYZ"[axis], "Move " + bone.name, place[axis], -kFar, kFar, "%.1f", "", end.bone, [&](const Armature& rig, double number) {
      return with_moved_ends(rig, {end}, [&](glm::dvec3 p) {
        p[axis] = number;
        return p;
      });
    });
    fill({field.low, {field.low.x + look.px(3), field.high.y}}, look.theme.axis[axis]);
  }
}

}  // namespace

void draw_bone(Editor& editor, Column& column) {
  const std::shared_ptr<const Armature> rig = shown_rig(editor);
  const auto chosen = editor.selection.bone;
  if (editor.workspace != Workspace::Rig || !rig || !chosen || *chosen >= std::ssize(rig->bones) || *chosen >= std::ssize(editor.document().armature->bones)) return;
  const int index = *chosen;
  const Bone bone = rig->bones[index];
  const Look& look = editor.look;
  if (column.begin_section("Bone", bone.name)) {
    column.space(6);
    const Rect parent = column.property("Parent");
    put_text(editor, look.fonts.regular, look.theme.text, parent, bone.parent < 0 ? "None" : rig->bones[bone.parent].name + (is_connected(*rig, index) ? ", connected" : ""));
    draw_end(editor, column, bone, {index, false});
    draw_end(editor, column, bone, {index, true});
    const Rect rect = column.property("Length \u00b7 roll");
    const float middle = std::round(rect.centre().x);
    draw_number(editor, {rect.low, {middle - look.px(2), rect.high.y}}, "Length", "Length of " + bone.name, glm::distance(bone.head, bone.tail), 0.01, kFar, "%.1f", "mm", index, [&](const Armature& before, double number) {
      const glm::dvec3 along = before.bones[index].tail - before.bones[index].head;
      const double length = glm::length(along);
      return with_moved_ends(before, {{index, true}}, [&](const glm::dvec3&) { return before.bones[index].head + (length > 0 ? along / length : glm::dvec3(0, 0, 1)) * number; });
    });
    draw_number(editor, {{middle + look.px(2), rect.low.y}, rect.high}, "Roll", "Roll " + bone.name, glm::degrees(bone.roll), -180, 180, "%.1f", "\u00b0", index,
                [&](const Armature& before, double number) { return rolled(before, {index}, glm::radians(number) - before.bones[index].roll); });
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
