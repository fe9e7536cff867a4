// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor with a trunk and an arm that touch, in the Skin workspace.
#pragma once

#include "editor/context/background_task.h"
#include "editor/context/open_project.h"
#include "editor/context/view_projection.h"
#include "editor/seams/seam_view.h"
#include "editor/shown/frame_all.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_editor.h"
#include "tests/support/glued_arm.h"

namespace limber::test {

using namespace editor;

inline Document glued_document(bool names = false) {
  const GluedArm body(-3, names);
  Document document;
  document.volume = std::make_shared<const LabelVolume>(body.volume);
  TissueTable tissues = body.tissues;
  for (Tissue& tissue : tissues.tissues) apply_kind_defaults(tissue);
  document.tissues = std::make_shared<const TissueTable>(tissues);
  document.volume_type = std::make_shared<const FileType>();
  document.armature = std::make_shared<const Armature>(body.rig);
  return document;
}

struct GluedEditor : SmallEditor {
  TemporaryFolder folder;

  explicit GluedEditor(float scale = 1)
      : SmallEditor(scale > 1 ? glm::ivec2(2000, 1200) : glm::ivec2(1000, 600), preferences_of(scale), false) {
    editor->history->reset(glued_document(), "Open glued arm");
    editor->project->name = "glued";
    editor->background->worker_program = LIMBER_PROGRAM;
    editor->preferences->reduce_motion = true;
    editor::frame_all(*editor, false);
    play("key Ctrl+2\nmove \"3D view/view\"\nkey Num1\nwait-idle");
  }
  static Preferences preferences_of(float scale) {
    Preferences preferences;
    preferences.scale = scale;
    return preferences;
  }

  void open_only(const std::string& section) {
    for (const char* folded : {"Bones", "Layers", "Brush", "Problems", "Outliner", "Steps", "Seams", "Bone map"})
      editor->ui->open_sections[folded] = folded == section;
    play("wait-idle");
  }
  std::int64_t faces() const {
    const auto seams = shown_seams(*editor);
    return seams && *seams ? (*seams)->size() : 0;
  }
  int steps() const { return static_cast<int>(editor->history->position()); }
  std::string last_edit() const { return editor->history->steps()[editor->history->position()].label; }
  // Returns the pixel at which the view shows a point, as if the interface scale were 1.
  std::string at(const glm::dvec3& point) const {
    const glm::dvec2 pixel = body_seen(*editor)->pixel_of(point).value() / double(editor->ui->look.scale);
    char line[80];
    std::snprintf(line, sizeof line, "%.4f %.4f", pixel.x, pixel.y);
    return line;
  }
  void stroke(const std::string& from, const std::string& to, bool erases = false) {
    play("move " + from);
    if (erases) play("key-down Ctrl");
    host->events.push(ButtonChanged{MouseButton::Left, true});
    player.settle();
    play("move " + to);
    host->events.push(ButtonChanged{MouseButton::Left, false});
    player.settle();
    if (erases) play("key-up Ctrl");
    play("wait-idle");
  }
};

}  // namespace limber::test
