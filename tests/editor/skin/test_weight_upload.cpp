// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/screen.h"
#include "editor/shown/frame_all.h"
#include "render/passes/pass_resources.h"
#include "tests/editor/small_limb.h"
#include "tests/render/studio.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;

namespace {

// A block of 1.5 million tissue voxels, more than one frame uploads to the graphics card.
struct LargeEditor : LimbEditor {
  LargeEditor() : LimbEditor({1000, 600}) {
    Document next = editor->document();
    auto volume = std::make_shared<LabelVolume>();
    volume->grid.size = {140, 100, 120};
    volume->voxels.assign(static_cast<std::size_t>(volume->grid.voxel_count()), 0);
    for (int z = 2; z < 118; ++z)
      for (int y = 2; y < 98; ++y)
        for (int x = 2; x < 138; ++x) volume->at({x, y, z}) = 17;
    next.volume = volume;
    next.weights = weights_of(*volume, 450);
    editor->history->reset(next, "Open block");
    editor->preferences->reduce_motion = true;
    draw_finely();
    frame_all(*editor, false);
    play("key N\nkey Ctrl+2\nkey Num1\nwait-idle");
  }

  static std::shared_ptr<const SkinWeights> weights_of(const LabelVolume& volume, int slope) {
    const TissueVoxels tissue(volume);
    SkinWeights weights({"Upper", "Fore"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk = weights.chunk(brick);
      tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
        chunk[place - tissue.bricks()[brick].first] =
            quantize({{0, kFullWeight - slope * voxel.x}, {1, slope * voxel.x}});
      });
      weights.set_chunk(brick, chunk);
    }
    return std::make_shared<const SkinWeights>(weights);
  }

  const render::WeightTexture& texture() {
    return *editor->views->renderer.resources().body(editor->document().volume).weights;
  }

  void to_rest() {
    do {
      player.step();
      if (!texture().complete()) CHECK(!editor->at_rest());
    } while (!editor->at_rest());
    CHECK(texture().complete());
  }

  void looks_as_anew() {
    render::Renderer fresh;
    int slices = 0;
    for (const ViewPlace& place : editor->screen->layout.view_places) {
      const glm::ivec2 size(place.rect.size());
      if (place.id == ViewId::Body) {
        render::View3D anew(fresh);
        double now = 0;
        do anew.draw(editor->views->scene, editor->views->body.camera, size, now += 0.2);
        while (!anew.complete());
        CHECK(test::difference(editor->views->body.picture->read(), anew.read()).mean < 0.5);
      } else {
        render::SliceView anew(fresh);
        SliceState& slice = slice_of(*editor->views, place.id);
        anew.draw(editor->views->scene, slice.camera, editor->views->slice_display, size);
        CHECK(test::difference(slice.picture->read(), anew.read()).mean == 0);
        ++slices;
      }
    }
    CHECK(slices > 0);
  }
};

}  // namespace

TEST_CASE(
    "weight upload: an edit of a large body, undo and redo are on the card when the editor rests, never before, and "
    "look as drawn anew") {
  LargeEditor test;
  REQUIRE(test.texture().complete());
  test.looks_as_anew();
  Document next = test.editor->document();
  next.weights = LargeEditor::weights_of(*next.volume, 300);
  int changes = test.texture().changes();
  commit(*test.editor, "Edit all", next);
  test.to_rest();
  CHECK(test.texture().changes() > changes);
  test.looks_as_anew();
  for (const char* key : {"key Ctrl+Z", "key Shift+Ctrl+Z"}) {
    changes = test.texture().changes();
    test.play(key);
    test.to_rest();
    CHECK(test.texture().changes() > changes);
    test.looks_as_anew();
  }
}
