// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/arriving_body.h"

#include <thread>

#include "editor/files/import.h"
#include "render/passes/pass_resources.h"
#include "tests/editor/operator_proofs.h"

using namespace limber;
using namespace limber::test;

namespace {

std::shared_ptr<const LabelVolume> cube() {
  auto volume = std::make_shared<LabelVolume>(LabelVolume{{.size = glm::ivec3(40)}, {}});
  volume->voxels.assign(static_cast<std::size_t>(volume->grid.voxel_count()), 1);
  return volume;
}

}  // namespace

TEST_CASE("arriving body: the frame that shows an opened body finds it uploaded") {
  const Home home;
  Sitting sitting(home.folder.path());
  bool was_there = false;
  editor::open_volume(sitting.editor(), home / "scans/ball.nrrd",
                      [&](editor::Context& c) { was_there = c.views->renderer.resources().has(c.document().volume); });
  sitting.play("wait-job\n wait-idle");
  REQUIRE(sitting.editor().document().volume);
  CHECK(was_there);
}

TEST_CASE("arriving body: without frames a job goes on at once, and a cancelled one stops") {
  const Home home;
  Sitting sitting(home.folder.path());
  editor::ArrivingBodies arriving;
  const auto body = render::prepared_body(cube(), {}, render::Display::Solid, {.side = 2048}, no_progress());
  CHECK_FALSE(arriving.has_frames());
  arriving.await(body, no_progress());  // does not wait forever although nothing uploads the body

  class Stoppable : public Progress {};
  Stoppable progress;
  bool is_cancelled = false;
  CHECK_FALSE(arriving.upload(sitting.editor().views->renderer));
  CHECK(arriving.has_frames());
  std::thread job([&] {
    try {
      arriving.await(body, progress);
    } catch (const Cancelled&) {
      is_cancelled = true;
    }
  });
  progress.cancel();
  job.join();
  CHECK(is_cancelled);
}

TEST_CASE("arriving body: over a posed body with its weights shown, a volume of another grid is opened") {
  Stage stage;
  stage.play("key Ctrl+2\n wait-idle\n click \"Heat diffusion\"\n wait-job\n wait-idle");
  Document posed = stage.document();
  REQUIRE(posed.weights);
  Pose pose = rest_pose(*posed.armature);
  pose.rotation.back() = glm::angleAxis(0.5, glm::dvec3(1, 0, 0));
  posed.pose = std::make_shared<const Pose>(pose);
  const Path other = stage.home / "cube.nrrd";
  write_volume(*cube(), other);
  // The Skin workspace shows weights, the Pose workspace shows the body posed.
  for (const char* workspace : {"key Ctrl+2", "key Ctrl+3"}) {
    CAPTURE(workspace);
    stage.editor().history->reset(posed, "Posed limb");
    stage.play(std::string(workspace) + "\n wait-idle");
    editor::open_volume(stage.editor(), other);
    stage.play("wait-job\n wait-idle");
    REQUIRE(stage.document().volume);
    CHECK_FALSE(stage.document().volume->grid == posed.volume->grid);
    CHECK(stage.is("error", "none"));
  }
}

TEST_CASE("arriving body: the textures of closed bodies are freed") {
  const Home home;
  Sitting sitting(home.folder.path());
  const auto bodies = [&] { return sitting.editor().views->renderer.resources().body_count(); };
  for (int time = 0; time < 4; ++time) {
    editor::open_volume(sitting.editor(), home / "scans/ball.nrrd");
    sitting.play("wait-job\n wait-idle");
  }
  CHECK(bodies() <= 2);
}
