// SPDX-License-Identifier: AGPL-3.0-or-later
// The small editor with its own folders, like a user's session: recent files, journals and a home folder.
#pragma once

#include <cstdlib>
#include <string>

#include "editor/app/editor_session.h"
#include "editor/context/user_folders.h"
#include "editor/files/project_session.h"
#include "editor/resample/refined_pose.h"
#include "tests/editor/small_editor.h"

namespace limber::test {

struct Sitting {
  explicit Sitting(const std::filesystem::path& home, std::vector<Path> files = {},
                   const glm::ivec2& size = {1280, 720})
      : test(size, {}, false) {
    ::setenv("HOME", home.c_str(), 1);
    begin_editor_session(*test.editor, {home / "config", home / "cache", home / "edits"}, std::move(files));
    test.editor->refined->on = false;  // the tests wait for no refined poses
    test.play("wait-job");
  }
  ~Sitting() { end_editor_session(*test.editor); }

  void play(const std::string& script) { test.play(script); }
  editor::Editor& editor() { return *test.editor; }
  // Closes the start screen and shows the ball of small_body(), as if it had been opened.
  void open_ball() {
    auto opened = std::make_shared<editor::Opened>();
    opened->document = small_body();
    opened->name = "ball";
    opened->label = "Open ball";
    replace_project(editor(), opened);
    test.player.settle();
  }

  SmallEditor test;
};

// A home folder that contains a volume in a subfolder.
struct Home {
  Home() {
    std::filesystem::create_directories(folder / "scans");
    const Document body = small_body();
    write_volume(*body.volume, folder / "scans/ball.nrrd", *body.tissues);
  }
  std::filesystem::path operator/(const std::string& name) const { return folder / name; }

  TemporaryFolder folder;
};

}  // namespace limber::test
