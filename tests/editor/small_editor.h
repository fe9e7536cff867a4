// SPDX-License-Identifier: AGPL-3.0-or-later
// The real editor without a display, in a window that is small enough for software OpenGL. It has a body of four
// tissues on a mirrored and anisotropic grid, and a player that types and clicks.
#pragma once

#include <memory>

#include <doctest/doctest.h>

#include "core/volume_io/volume_io.h"
#include "editor/app/editor.h"
#include "editor/app/headless_window.h"
#include "editor/app/script_player.h"
#include "editor/context/background_task.h"
#include "editor/context/document_edits.h"
#include "editor/context/open_project.h"
#include "editor/context/views.h"
#include "editor/shown/frame_all.h"
#include "tests/support/program.h"

namespace limber::test {

// Makes a ball of skin around muscle around bone, and a small blood vessel: labels 143, 17, 111 and 65.
inline Document small_body() {
  auto volume = std::make_shared<LabelVolume>();
  volume->grid.size = {24, 20, 30};
  volume->grid.spacing = {4, 5, 3};
  volume->grid.origin = {-46, -48, -44};
  volume->voxels.assign(volume->grid.voxel_count(), 0);
  const AffineTransform world = world_from_voxel(volume->grid);
  for (int z = 0; z < 30; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) {
        const double r = glm::length(world * glm::dvec3(x, y, z));
        volume->at({x, y, z}) = r < 12 ? 111 : r < 32 ? 17 : r < 40 ? 143 : 0;
        if (r >= 12 && r < 32 && x == 12 && y < 8) volume->at({x, y, z}) = 65;
      }
  auto tissues = std::make_shared<TissueTable>();
  for (const auto& [label, name, kind] : {std::tuple<Label, const char*, TissueKind>{17, "Muscle", TissueKind::Muscle},
                                          {65, "Blood", TissueKind::Blood},
                                          {111, "Cortical bone", TissueKind::CorticalBone},
                                          {143, "Skin", TissueKind::Skin}}) {
    Tissue tissue;
    tissue.label = label;
    tissue.file_value = label;
    tissue.name = name;
    tissue.kind = kind;
    apply_kind_defaults(tissue);
    tissues->tissues.push_back(tissue);
  }
  Document document;
  document.volume = volume;
  document.tissues = tissues;
  document.volume_type = std::make_shared<FileType>();
  return document;
}

struct SmallEditor {
  explicit SmallEditor(const glm::ivec2& size = {1024, 640}, const editor::Preferences& preferences = {},
                       bool with_body = true)
      : host(editor::open_offscreen(size)),
        editor(std::make_unique<editor::Editor>(*host, preferences)),
        player(*editor, *host) {
    // Workers run at normal priority, since other tests run at the same time.
    editor->background->workers_yield = false;
    editor->views->renderer.average_at_rest(0);
    player.step();
    if (!with_body) return;
    editor->history->reset(small_body(), "Open ball");
    editor->project->name = "ball";
    editor::frame_all(*editor, false);
    player.settle();
  }

  // Draws at full quality, for tests that compare pictures.
  void draw_finely() {
    editor->views->renderer.average_at_rest(1);
    player.settle();
  }
  void play(const std::string& script) { player.play(script); }
  std::string fact(const std::string& name) const { return editor::fact(*editor, name); }

  std::unique_ptr<editor::Offscreen> host;
  std::unique_ptr<editor::Editor> editor;
  editor::Player player;
};

}  // namespace limber::test
