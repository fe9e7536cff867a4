// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/grey_image_panel.h"

#include <random>

#include "editor/files/import.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::test;

namespace {

// Returns a noisy ball of tissue in air. Its 8-bit values could also be mistaken for labels.
GreyVolume scan() {
  GreyVolume image;
  image.grid = {{24, 24, 24}, {2, 2, 2}, {-24, -24, -24}, glm::dmat3(1)};
  image.type = {"NRRD", "uint8", true};
  std::mt19937 random(3);
  for (int i = 0; i < 24 * 24 * 24; ++i) {
    const glm::dvec3 off(i % 24 - 11.5, i / 24 % 24 - 11.5, i / 576 - 11.5);
    const int noise = static_cast<int>(random() % 200);
    image.voxels.push_back(static_cast<float>(glm::length(off) < 9 ? 55 + noise : noise / 4));
  }
  return image;
}

struct Pictures : Home {
  Pictures() { write_grey_volume(scan(), *this / "mr8.nrrd"); }
};

}  // namespace

TEST_CASE("grey images: a file that may be either is shown in a dialog, and becomes no labels by itself") {
  const Pictures files;
  Sitting sitting(files.folder.path(), {files / "mr8.nrrd"});
  sitting.play("wait-idle\n expect dialog yes\n expect volume no\n expect error none");
  for (const char* text :
       {"mr8.nrrd is a grey image", "A grey image, not labels: it has ", "Axial", "Coronal", "Sagittal"}) {
    INFO(std::string(text));
    CHECK(sitting.test.fact(std::string("text:") + text) == "shown");
  }
  sitting.play("key Escape\n wait-idle\n expect dialog no\n expect volume no\n expect unsaved no");
  editor::open_files(sitting.editor(), {files / "mr8.nrrd"});
  sitting.play("wait-job\n wait-idle\n click \"Open as labels\"\n wait-idle\n expect dialog no\n expect volume yes");
  CHECK(sitting.editor().document().tissues->tissues.size() > 200);
}

TEST_CASE("grey images: importing one leaves the labels as they are until an answer says otherwise") {
  const Pictures files;
  Sitting sitting(files.folder.path(), {files / "scans/ball.nrrd"});
  const Document before = sitting.editor().document();
  sitting.play("key Ctrl+I\n wait-idle\n type " + (files / "mr8.nrrd").string() +
               "\n key Return\n wait-job\n wait-job\n wait-idle");
  sitting.play("expect dialog yes\n expect error none\n expect position 0\n expect unsaved no");
  CHECK(sitting.editor().document() == before);
  sitting.play("click \"Close image\"\n wait-idle\n expect dialog no");
  CHECK(sitting.editor().document() == before);
  CHECK_FALSE(sitting.editor().views->image);
  editor::import_file(sitting.editor(), editor::FileKind::Volume, files / "mr8.nrrd");
  sitting.play("wait-job\n wait-idle\n click \"Replace the labels\"\n wait-idle\n expect edit \"Import mr8.nrrd\"");
  CHECK(sitting.editor().document().volume != before.volume);
  sitting.play("key Ctrl+Z\n wait-idle");
  CHECK(sitting.editor().document().volume == before.volume);
  editor::import_file(sitting.editor(), editor::FileKind::Volume, files / "mr8.nrrd");
  sitting.play("wait-job\n wait-idle\n click \"Show as image\"\n wait-idle\n expect dialog no");
  CHECK(sitting.editor().views->image);
  CHECK(sitting.editor().document().volume == before.volume);
}

TEST_CASE("grey images: the window of values, the cross and the turn change what is drawn") {
  const Pictures files;
  Sitting sitting(files.folder.path(), {files / "mr8.nrrd"});
  sitting.play("wait-idle");
  render::Image last = sitting.test.host->picture();
  const auto changes = [&](const std::string& script) {
    sitting.play(script + "\n wait-idle\n expect dialog yes");
    render::Image next = sitting.test.host->picture();
    const bool changed = next.rgba != last.rgba;
    last = std::move(next);
    return changed;
  };
  CHECK(changes("drag dialog/Axial 40 30"));
  CHECK(changes("drag \"dialog/Maximum intensity, drag to turn\" 60 0"));
  CHECK(changes("drag dialog/Width 60 0"));
}
