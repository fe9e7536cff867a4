// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/arriving_body.h"

#include <thread>

#include "editor/files/import.h"
#include "render/passes/pass_resources.h"
#include "tests/editor/sitting.h"

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
                      [&](editor::Editor& e) { was_there = e.views->renderer.resources().has(e.document().volume); });
  sitting.play("wait-job\n wait-idle");
  REQUIRE(sitting.editor().document().volume);
  CHECK(was_there);
}

TEST_CASE("arriving body: without frames a job goes on at once, and a cancelled one stops") {
  const Home home;
  Sitting sitting(home.folder.path());
  editor::ArrivingBodies arriving;
  const auto body = render::prepared_body(cube(), {}, render::Display::Solid, 2048, no_progress());
  CHECK_FALSE(arriving.has_frames());
  arriving.await(body, no_progress());  // returns, though nobody uploads

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
