// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/file_browser.h"

#include <fstream>

#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::test;

TEST_CASE("file browser: a volume is found and opened by keyboard alone") {
  const Home home;
  std::ofstream(home / "scans/notes.txt") << "text";
  Sitting sitting(home.folder.path());
  sitting.play(R"(
    key Ctrl+O
    expect dialog yes
    type sca
    expect text:scans
    key Return
    expect widget:list/rows/ball.nrrd
    expect widget:notes.txt absent
    key Backspace
    expect widget:list/rows/scans
    key Return
    key Return
    wait-job
    expect dialog no
    expect volume yes
    expect name ball
    key Ctrl+O
    expect widget:list/rows/ball.nrrd     # where it was left
    key Escape
    expect dialog no
  )");
}

TEST_CASE("file browser: arrows, Tab, places, search and Escape work without a mouse") {
  const Home home;
  for (const char* name : {"a.nrrd", "b.nrrd", "c.nrrd"})
    std::filesystem::copy_file(home / "scans/ball.nrrd", home / (std::string("scans/") + name));
  Sitting sitting(home.folder.path());
  sitting.play(R"(
    key Ctrl+O
    type scans
    key Return
    key Down
    key Down
    key Up
    key Return
    wait-job
    expect name b
    key Ctrl+O
    type nothing
    expect "text:No name contains"
    key Escape
    expect dialog yes
    key Tab
    key Return            # the first place: home
    expect widget:list/rows/scans
    key Escape
    expect dialog no
  )");
}

TEST_CASE("file browser: by mouse, a double click opens, crumbs and places lead elsewhere, heads sort, types filter") {
  const Home home;
  std::ofstream(home / "scans/notes.txt") << "text";
  Sitting sitting(home.folder.path());
  sitting.play(R"(
    click "File/Open..."
    double-click list/rows/scans
    expect widget:list/rows/ball.nrrd
    click list/rows/ball.nrrd
    click Size
    click Modified
    click path/Home
    expect widget:list/rows/scans
    double-click list/rows/scans
    click dialog/Type
    click "Type/All files"
    expect widget:list/rows/notes.txt
    double-click list/rows/ball.nrrd
    wait-job
    expect volume yes
  )");
}

TEST_CASE("file browser: hidden files are shown on demand, and a new folder is made and entered") {
  const Home home;
  std::filesystem::create_directory(home / ".secret");
  Sitting sitting(home.folder.path());
  sitting.play(R"(
    key Ctrl+O
    expect widget:list/rows/.secret absent
    key Ctrl+H
    expect widget:list/rows/.secret
    click "Hidden files"
    expect widget:list/rows/.secret absent
    click "New folder"
    type posed
    key Return
    wait-idle
    expect "text:This folder is empty"
    key Escape
  )");
  CHECK(std::filesystem::is_directory(home / "posed"));
}

TEST_CASE(
    "file browser: saving asks before it replaces a file, appends the type's end, and a folder that is not there is "
    "told") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  std::ofstream(home / "there.limber") << "something else";
  sitting.play(R"(
    click "File/Save as..."
    type there
    key Return
    expect "text:there.limber already exists"
    key Return
    expect "text:there.limber already exists"
    click "Keep file"
    key Escape
    expect dialog no
  )");
  CHECK(std::filesystem::file_size(home / "there.limber") == 14);
  sitting.play(R"(
    key Ctrl+S
    type there
    key Return
    click Replace
    wait-job
    expect unsaved no
    expect name there.limber
    click "File/Save a copy..."
    type missing/x
    key Return
    expect dialog yes
  )");
  CHECK(sitting.test.fact("toast").starts_with("There is no folder"));
}

TEST_CASE("file browser: a folder that cannot be read says so") {
  const Home home;
  Sitting sitting(home.folder.path());
  std::filesystem::create_directory(home / "gone");
  sitting.play("key Ctrl+O\n type gone");
  std::filesystem::remove(home / "gone");
  sitting.play("key Return\n expect text:\"This folder does not exist\"\n key Escape");
}

TEST_CASE("file browser: a folder of DICOM images is offered as one volume") {
  const Home home;
  std::ofstream(home / "scans/IM1") << std::string(128, '\0') << "DICM but damaged";
  Sitting sitting(home.folder.path());
  sitting.play(R"(
    key Ctrl+O
    type scans
    key Return
    expect "text:This folder contains DICOM images"
    click "Open as one volume"
    wait-job
    expect volume no
  )");
  CHECK(sitting.test.fact("error") != "none");
}
