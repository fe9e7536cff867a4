// SPDX-License-Identifier: AGPL-3.0-or-later
// The limb with weights in the Skin workspace, ready to be painted with the pointer.
#pragma once

#include <cmath>
#include <cstdio>

#include "core/project/history.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/ui.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

using namespace editor;

// The ball seen from the front. Its upper half follows the upper bone, its lower half the lower bone.
struct PaintEditor : LimbEditor {
  explicit PaintEditor(float scale = 1, bool parallel = false)
      : LimbEditor(scale > 1 ? glm::ivec2(2000, 1200) : glm::ivec2(1000, 600), preferences_of(scale)) {
    Document next = editor->document();
    next.weights = test::half_weights(*next.volume);
    editor->history->reset(next, "Open weighted limb");
    editor->preferences->reduce_motion = true;
    play("key N\nkey Ctrl+2\nmove \"3D view/view\"\nkey Num1\nwait-idle");
    if (parallel) play("key Num5\nwait-idle");
    choose(1);
    editor->skin->painting->strength = 1;
    editor->skin->painting->radius = 12;
    editor->skin->painting->depth = BrushDepth::Through;
    editor->skin->painting->falloff = FalloffShape::Constant;
  }
  static Preferences preferences_of(float scale) {
    Preferences preferences;
    preferences.scale = scale;
    return preferences;
  }

  void choose(int bone) {
    editor->selection->bone = bone;
    editor->selection->bones = {bone};
    play("wait-idle");
  }
  // Returns the pixel at which the 3D view shows a point of the ball's front, as if the interface scale were 1.
  std::string pixel_of(const glm::dvec3& point) const {
    const glm::dvec2 pixel = body_seen(*editor)->pixel_of(point).value() / double(editor->ui->look.scale);
    char line[80];
    std::snprintf(line, sizeof line, "%.4f %.4f", pixel.x, pixel.y);
    return line;
  }
  std::string at(double x, double z) const { return pixel_of({x, -std::sqrt(1600 - x * x - z * z), z}); }
  void press(MouseButton button = MouseButton::Left) {
    host->events.push(ButtonChanged{button, true});
    player.settle();
  }
  void release(MouseButton button = MouseButton::Left) {
    host->events.push(ButtonChanged{button, false});
    player.settle();
  }
  void stroke(const std::string& from, const std::string& to) {
    play("move " + from);
    press();
    play("move " + to);
    release();
  }
  const SkinWeights& weights() const { return *editor->document().weights; }
  int steps() const { return static_cast<int>(editor->history->position()); }
  std::string last_edit() const { return editor->history->steps()[editor->history->position()].label; }
  // Calls body(world, voxel, influence) for each tissue voxel.
  template <class Body>
  void for_each(const Body& body) const {
    const TissueVoxels tissue(*editor->document().volume);
    const AffineTransform world = world_from_voxel(editor->document().volume->grid);
    for (std::int64_t brick = 0; brick < weights().chunk_count(); ++brick)
      tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
        body(world * glm::dvec3(voxel), voxel, weights().chunk(brick)[place - tissue.bricks()[brick].first]);
      });
  }
  // Counts the voxels of one half in which `bone` has weight. Returns the count, and the largest distance of these
  // voxels to `from`, mm.
  std::pair<int, double> painted(int bone, const glm::dvec3& from, bool upper) const {
    int count = 0;
    double furthest = 0;
    for_each([&](const glm::dvec3& p, const glm::ivec3&, const Influence& influence) {
      if ((p.z >= 0) != upper || influence.of(bone) == 0) return;
      ++count;
      furthest = std::max(furthest, glm::distance(p, from));
    });
    return {count, furthest};
  }
};

}  // namespace limber::test
