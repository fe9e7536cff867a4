// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/grey_image_panel.h"

#include <random>

#include "editor/files/import.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::test;

namespace {

// A noisy ball of tissue in air, in Hounsfield units.
GreyVolume scan(const std::string& type) {
  GreyVolume image;
  image.grid = {{24, 24, 24}, {2, 2, 2}, {-24, -24, -24}, glm::dmat3(1)};
  image.type = {"NRRD", type, true};
  std::mt19937 random(3);
  for (int i = 0; i < 24 * 24 * 24; ++i) {
    const glm::dvec3 off(i % 24 - 11.5, i / 24 % 24 - 11.5, i / 576 - 11.5);
    const int noise = static_cast<int>(random() % 200);
    image.voxels.push_back(static_cast<float>(glm::length(off) < 9 ? 100 + noise : -1000 + noise) +
                           (type == "float" ? 0.25f : 0));
  }
  return image;
}

struct Scans : Home {
  Scans() {
    write_grey_volume(scan("int16"), *this / "ct.nrrd");
    write_grey_volume(scan("float"), *this / "mr.nrrd");
  }
};

}  // namespace

TEST_CASE("grey images: one that is opened is said to be one and shown, and becomes no labels by itself") {
  const Scans files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"});
  sitting.play("wait-idle\n expect dialog yes\n expect volume no\n expect error none");
  for (const char* text :
       {"ct.nrrd is a grey image", "A grey image, not labels: it has ", "Axial", "Coronal", "Sagittal"}) {
    INFO(std::string(text));
    CHECK(sitting.test.fact(std::string("text:") + text) == "shown");
  }
  sitting.play("key Escape\n wait-idle\n expect dialog no\n expect volume no\n expect unsaved no");
  editor::open_files(sitting.editor(), {files / "ct.nrrd"});
  sitting.play("wait-job\n wait-idle\n click \"Open as labels\"\n wait-idle\n expect dialog no\n expect volume yes");
  CHECK(sitting.editor().document().tissues->tissues.size() > 300);
}

TEST_CASE("grey images: importing one leaves the labels as they are until an answer says otherwise") {
  const Scans files;
  Sitting sitting(files.folder.path(), {files / "scans/ball.nrrd"});
  const Document before = sitting.editor().document();
  const auto import = [&](const char* name) {
    sitting.play("key Ctrl+I\n wait-idle\n type " + (files / name).string() +
                 "\n key Return\n wait-job\n wait-job\n wait-idle");
  };
  for (const char* name : {"ct.nrrd", "mr.nrrd"}) {
    import(name);
    sitting.play("expect dialog yes\n expect error none\n expect position 0\n expect unsaved no");
    CHECK(sitting.editor().document() == before);
    // Fractions cannot be labels at all.
    CHECK((sitting.test.fact("text:Replace the labels") == "shown") == (std::string(name) == "ct.nrrd"));
    sitting.play("click \"Close image\"\n wait-idle\n expect dialog no");
    CHECK(sitting.editor().document() == before);
  }
  editor::import_file(sitting.editor(), editor::FileKind::Volume, files / "ct.nrrd");
  sitting.play("wait-job\n wait-idle\n click \"Replace the labels\"\n wait-idle\n expect edit \"Import ct.nrrd\"");
  CHECK(sitting.editor().document().volume != before.volume);
  sitting.play("key Ctrl+Z\n wait-idle");
  CHECK(sitting.editor().document().volume == before.volume);
}

TEST_CASE("grey images: the window of values, the cross and the turn change what is drawn") {
  const Scans files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"});
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
