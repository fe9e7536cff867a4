// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/skin/painting.h"

#include <cmath>

#include "core/rig/mirror.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/skin/weight_display.h"
#include "editor/volume/tissue_edits.h"
#include "tests/editor/paint_editor.h"

using namespace limber;
using namespace limber::editor;
using limber::test::PaintEditor;

TEST_CASE("painting: a stroke lands where the pointer is, in both projections and at twice the size, and is one edit") {
  for (const float scale : {1.0f, 2.0f})
    for (const bool parallel : {false, true}) {
      PaintEditor test(scale, parallel);
      const auto before = test.editor->document().weights;
      const int steps = test.steps();
      const glm::dvec3 centre(0, -std::sqrt(1600 - 400), 20);
      test.stroke(test.at(0, 20), test.at(0, 20));
      INFO("scale ", scale, ", parallel ", parallel);
      CHECK(test.steps() == steps + 1);
      CHECK(test.last_edit() == "Add Fore");
      const auto [count, furthest] = test.painted(1, centre, true);
      CHECK(count > 20);
      CHECK(furthest < 12 + 6);  // mm: the radius, and a voxel's diagonal as the tolerance of the surface
      // With constant falloff at full strength, the bone gets all of the weight, and each sum is exact.
      test.for_each([&](const glm::dvec3& p, const glm::ivec3&, const Influence& i) {
        CHECK(i.weight[0] + i.weight[1] + i.weight[2] + i.weight[3] == kFullWeight);
        if (glm::distance(p, centre) < 5) CHECK(i == rigid_influence(1));
      });
      CHECK(!test.editor->views->preview_weights);
      test.play("key Ctrl+Z");
      CHECK(test.editor->document().weights == before);
    }
}

TEST_CASE(
    "painting: each brush paints by the mouse as it is shown while it does, keeps what is locked, and is one edit that "
    "is undone and redone") {
  bool parallel = false;
  for (const BrushKind kind :
       {BrushKind::Add, BrushKind::Subtract, BrushKind::Set, BrushKind::Multiply, BrushKind::Smooth, BrushKind::Sharpen,
        BrushKind::Average, BrushKind::Smear, BrushKind::JointCapsule}) {
    PaintEditor test(1, parallel);
    INFO(name_of(kind), ", parallel ", parallel);
    // Weights that change smoothly along the ball, so that there is something to sharpen and to smear.
    Document blended = test.editor->document();
    SkinWeights weights = *blended.weights;
    const TissueVoxels tissue(*blended.volume);
    const AffineTransform world = world_from_voxel(blended.volume->grid);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk = weights.chunk(brick);
      tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
        const double fore = 1 / (1 + std::exp((world * glm::dvec3(v)).z / 6));
        chunk[place - tissue.bricks()[brick].first] = quantize({{0, 1 - fore}, {1, fore}});
      });
      weights.set_chunk(brick, chunk);
    }
    blended.weights = std::make_shared<const SkinWeights>(std::move(weights));
    test.editor->history->reset(blended, "Open blended limb");
    test.play("wait-idle");
    test.editor->skin->painting->kind = kind;
    test.editor->skin->painting->value = 0.5;
    test.editor->skin->painting->strength = 0.7;
    const auto before = test.editor->document().weights;
    const int steps = test.steps();
    test.play("move " + test.at(-6, 4));
    test.press();
    test.play("move " + test.at(4, -3) + "\nmove " + test.at(8, 3));
    REQUIRE(test.editor->views->preview_weights);
    const SkinWeights seen = *test.editor->views->preview_weights;
    test.release();
    CHECK(test.steps() == steps + 1);
    CHECK(test.last_edit() == std::string(name_of(kind)) + " Fore");
    CHECK(test.weights() == seen);
    CHECK(test.weights() != *before);
    const Document& document = test.editor->document();
    double gained = 0;
    int wrong = 0;
    test.for_each([&](const glm::dvec3& p, const glm::ivec3& voxel, const Influence& i) {
      const int brick = tissue.brick_at(voxel);
      const Influence& was = before->chunk(brick)[tissue.index_of(voxel) - tissue.bricks()[brick].first];
      wrong += i.weight[0] + i.weight[1] + i.weight[2] + i.weight[3] != kFullWeight;
      wrong += i != was && (document.volume->at(voxel) == 111 || std::abs(p.z) > 25);
      gained += i.of(1) - was.of(1);
    });
    CHECK(wrong == 0);
    if (kind == BrushKind::Add) CHECK(gained > 1);
    if (kind == BrushKind::Subtract || kind == BrushKind::Multiply) CHECK(gained < -1);
    test.play("key Ctrl+Z");
    CHECK(test.editor->document().weights == before);
    test.play("key Ctrl+Shift+Z");
    CHECK(test.weights() == seen);

    // If the other bone is locked, there is nothing to take from, so no bit changes.
    test.play("key Ctrl+Z");
    toggle_lock(*test.editor, 0);
    const int unlocked = test.steps();
    test.stroke(test.at(-6, 4), test.at(8, 3));
    CHECK(test.steps() == unlocked);
    CHECK(*test.editor->document().weights == *before);
    // Perspective and parallel views alternate: strokes land at the same points in both.
    parallel = !parallel;
  }
}

TEST_CASE(
    "painting: how a brush is set is how it paints: strength, spacing, accumulating, depth, falloff, distance, what is "
    "seen") {
  const auto painted_by = [](const std::function<void(PaintEditor&)>& set,
                             const std::function<void(PaintEditor&)>& paint = {}) {
    PaintEditor test;
    set(test);
    if (paint) paint(test);
    else test.stroke(test.at(0, 20), test.at(0, 20));
    struct {
      double weight = 0, deepest = 1e9, most = 0;
      int voxels = 0;
    } found;
    test.for_each([&](const glm::dvec3& p, const glm::ivec3&, const Influence& i) {
      if (p.z < 0 || i.of(1) == 0) return;
      ++found.voxels;
      found.weight += i.of(1);
      found.most = std::max(found.most, i.of(1));
      found.deepest = std::min(found.deepest, glm::length(p));
    });
    return found;
  };
  const auto plain = painted_by([](PaintEditor&) {});
  REQUIRE(plain.voxels > 30);
  CHECK(plain.most == 1);
  CHECK(painted_by([](PaintEditor& t) { t.editor->skin->painting->strength = 0.4; }).most ==
        doctest::Approx(0.4).epsilon(1e-3));
  CHECK(painted_by([](PaintEditor& t) { t.editor->skin->painting->radius = 6; }).voxels < 0.4 * plain.voxels);
  // Falloff reduces the weight that a brush adds towards its rim. A sharp falloff adds least.
  const auto smooth = painted_by([](PaintEditor&t) { run(*t.editor, "skin.falloff_smooth"); }),
             sharp = painted_by([](PaintEditor&t) { run(*t.editor, "skin.falloff_sharp"); });
  CHECK(smooth.weight < 0.8 * plain.weight);
  CHECK(sharp.weight < 0.8 * smooth.weight);
  // A brush reaches the surface only, or down to a depth below it, or through the whole body: each reach gets deeper.
  const auto surface = painted_by([](PaintEditor& t) { run(*t.editor, "skin.reach_surface"); });
  const auto depth =
      painted_by([](PaintEditor& t) { run(*t.editor, "skin.reach_depth"), t.editor->skin->painting->depth_mm = 8; });
  CHECK(surface.deepest > depth.deepest);
  CHECK(depth.deepest > plain.deepest);
  CHECK(depth.deepest > 40 - 8 - 4);
  // Going over the same point again adds weight only if accumulation is on.
  const auto twice = [](PaintEditor& t) {
    t.play("move " + t.at(0, 20));
    t.press();
    for (int i = 0; i < 4; ++i) t.play("move " + t.at(14, 20) + "\nmove " + t.at(0, 20));
    t.release();
  };
  const auto weak = [](PaintEditor& t) { t.editor->skin->painting->strength = 0.05; };
  CHECK(painted_by(weak, twice).most == doctest::Approx(0.05).epsilon(1e-3));
  CHECK(painted_by([&](PaintEditor& t) { weak(t), run(*t.editor, "skin.accumulate"); }, twice).most > 0.2);
  // Dabs with a large spacing leave gaps along the stroke.
  const auto way = [](PaintEditor& t) { t.stroke(t.at(-18, 20), t.at(18, 20)); };
  const auto close_by = painted_by([](PaintEditor& t) { t.editor->skin->painting->radius = 5; }, way);
  CHECK(painted_by([](PaintEditor& t) { t.editor->skin->painting->radius = 5, t.editor->skin->painting->spacing = 4; },
                   way)
            .voxels < 0.8 * close_by.voxels);
  // If only the visible surface is painted, clipped voxels keep their weights.
  CHECK(painted_by(
            [](PaintEditor& t) {
              run(*t.editor, "skin.paint_visible");
              Document next = t.editor->document();
              Visibility visibility = next.visibility ? *next.visibility : Visibility{};
              visibility.clip_plane = {.enabled = true, .point = {0, 0, 0}, .normal = {1, 0, 0}};
              next.visibility = std::make_shared<const Visibility>(visibility);
              t.editor->history->commit("Clip", next);
              t.play("wait-idle");
            },
            [](PaintEditor& t) { t.stroke(t.at(-4, 20), t.at(-4, 20)); })
            .voxels < 0.9 * plain.voxels);
}

TEST_CASE(
    "painting: it is seen while the button is down, Escape drops it, and a stroke that changes nothing is no edit") {
  PaintEditor test;
  const auto before = test.editor->document().weights;
  const int steps = test.steps();
  test.play("move " + test.at(0, 20));
  test.press();
  REQUIRE(test.editor->views->preview_weights);
  CHECK(test.editor->views->scene.weights->weights == test.editor->views->preview_weights);
  test.play("move " + test.at(12, 20));
  test.play("key Escape\nwait-idle");
  CHECK(!test.editor->views->preview_weights);
  CHECK(!test.editor->skin->painting->running);
  test.release();
  CHECK(test.editor->document().weights == before);
  CHECK(test.steps() == steps);

  test.stroke(test.at(0, -20), test.at(0, -25));  // the bone has all of the weight there already
  CHECK(test.steps() == steps);
  test.stroke("300 90", "310 90");  // the stroke misses the body
  CHECK(test.steps() == steps);
  CHECK(test.editor->messages->toasts.empty());
}

TEST_CASE("painting: where a lock is in the way nothing changes by one bit, it is named, and one click undoes it") {
  PaintEditor test;
  toggle_lock(*test.editor, 0);
  const auto before = test.editor->document().weights;
  const int steps = test.steps();
  test.stroke(test.at(0, 20), test.at(10, 20));
  CHECK(test.editor->document().weights == before);
  CHECK(test.steps() == steps);
  REQUIRE(test.editor->messages->toasts.size() == 1);
  CHECK(test.editor->messages->toasts[0].line == "Upper is locked");
  CHECK(test.editor->messages->toasts[0].action == "skin.unlock_all");
  run(*test.editor, "skin.unlock_all");
  test.stroke(test.at(0, 20), test.at(10, 20));
  CHECK(test.editor->document().weights != before);
}

TEST_CASE("painting: Ctrl takes away, Shift smooths, whatever the brush, the other bone gets what is taken") {
  PaintEditor test;
  test.play("key-down Ctrl");
  test.stroke(test.at(0, -20), test.at(0, -20));
  test.play("key-up Ctrl");
  CHECK(test.last_edit() == "Subtract Fore");
  CHECK(test.painted(0, {0, 0, 0}, false).first > 20);

  test.editor->skin->painting->strength = 0.5;
  test.play("key-down Shift");
  test.stroke(test.at(0, 0), test.at(10, 0));
  test.play("key-up Shift");
  CHECK(test.last_edit() == "Smooth Fore");
  int blended = 0;
  test.for_each(
      [&](const glm::dvec3&, const glm::ivec3&, const Influence& i) { blended += i.of(1) > 0 && i.of(1) < 1; });
  CHECK(blended > 10);
}

TEST_CASE("painting: the ring and the hints say that Ctrl takes away and Shift smooths") {
  PaintEditor test;
  test.play("move " + test.at(0, -20) + "\nwait-idle");
  // Counts the pixels of a colour. Nothing but the ring, its tick and its sign has the bright colour of errors over a
  // view; the colour of accents is that of a few words, too.
  const auto pixels_of = [&](int r, int g, int b) {
    const render::Image picture = test.host->picture();
    int count = 0;
    for (std::size_t i = 0; i + 3 < picture.rgba.size(); i += 4)
      count += picture.rgba[i] == r && picture.rgba[i + 1] == g && picture.rgba[i + 2] == b;
    return count;
  };
  const auto red = [&] { return pixels_of(0xFF, 0x7A, 0x80); };
  const auto blue = [&] { return pixels_of(0x8F, 0xBE, 0xFF); };
  CHECK(red() == 0);
  const int words = blue();
  test.play("key-down Ctrl\nwait-idle\nexpect \"text:Paint inverse\" shown");
  CHECK(red() > 20);
  CHECK(blue() == words);
  test.play("key-up Ctrl\nkey-down Shift\nwait-idle\nexpect \"text:Smooth weights\" shown");
  CHECK(blue() > words + 20);
  CHECK(red() == 0);
  test.play("key-up Shift\nwait-idle");
  CHECK(red() == 0);
  CHECK(blue() == words);
  // Ctrl makes a brush that subtracts add weight. The ring has the colour of errors only if weight is taken away.
  test.editor->skin->painting->kind = BrushKind::Subtract;
  test.play("key-down Ctrl\nwait-idle");
  CHECK(red() == 0);
  test.play("key-up Ctrl");
}

TEST_CASE("painting: in a slice the brush is the ball that the circle shows, and bone follows its bone still") {
  PaintEditor test;
  test.editor->skin->painting->distance = BrushDistance::Euclidean;
  test.play("click \"header/view.four\"\nwait-idle");
  std::optional<ViewPlace> slice;
  for (const ViewPlace& place : test.editor->screen->layout.view_places)
    if (place.id != ViewId::Body && axis_of(place.id) == render::SliceAxis::Axial) slice = place;
  REQUIRE(slice);
  test.editor->views->cross_hair = {0, 0, 15};
  slice_of(*test.editor->views, slice->id).fitted = false;
  test.play("wait-idle");
  const ViewProjection seen(*test.editor, *slice);
  const glm::dvec3 point(18, 0, glm::dot(seen.slice.centre, glm::dvec3(0, 0, 1)));
  const glm::dvec2 pixel = seen.pixel_of(point).value();
  const int steps = test.steps();
  char line[80];
  std::snprintf(line, sizeof line, "%.4f %.4f", pixel.x, pixel.y);
  test.stroke(line, line);
  CHECK(test.steps() == steps + 1);
  int wrong = 0, inside = 0;
  const Document& document = test.editor->document();
  test.for_each([&](const glm::dvec3& p, const glm::ivec3& voxel, const Influence& i) {
    if (p.z < 0) return;
    const double off = glm::distance(p, point);
    const bool bone = document.volume->at(voxel) == 111;
    if (off < 11.5) ++inside, wrong += (i.of(1) == 1) == bone;
    if (off > 12.5) wrong += i.of(1) != 0;
  });
  CHECK(inside > 30);
  CHECK(wrong == 0);
}

TEST_CASE("painting: radius, strength and value are set with the pointer, typed, or given up") {
  PaintEditor test;
  Painting& painting = *test.editor->skin->painting;
  test.play("move " + test.at(0, 10) + "\nwait-idle\nkey F");
  REQUIRE(test.editor->interaction->modal);
  test.play("key 2\nkey 5\nkey Return");
  CHECK(!test.editor->interaction->modal);
  CHECK(painting.radius == 25);
  // While F sets the radius, the pointer moves away from the brush's centre by 10 mm, so the radius grows by 10 mm.
  const double millimetres = body_seen(*test.editor)->millimetres_per_pixel({0, -38.7, 10});
  test.play("key F");
  const glm::vec2 from = test.editor->ui->input.pointer;
  char line[80];
  std::snprintf(line, sizeof line, "move %.3f %.3f", from.x + 10 / millimetres, from.y);
  test.play(line);
  CHECK(painting.radius == doctest::Approx(35).epsilon(0.02));
  test.play("key Escape");
  CHECK(painting.radius == 25);
  test.play("key [");
  CHECK(painting.radius == doctest::Approx(25 / 1.15));
  test.play("key ]");
  CHECK(painting.radius == doctest::Approx(25));
  test.play("key Shift+F\nkey .\nkey 3\nkey Return");
  CHECK(painting.strength == doctest::Approx(0.3));
  test.play("key Ctrl+F\nkey .\nkey 2\nkey 5\nkey Return");
  CHECK(painting.value == doctest::Approx(0.25));
  test.play("key Shift+]");
  CHECK(painting.strength == doctest::Approx(0.35));
  test.play("key F\nkey 0\nkey Return");
  CHECK(painting.radius == Painting::kLeastRadius);
}

TEST_CASE("painting: only the tissue that the filter lets through changes") {
  PaintEditor test;
  test.editor->skin->painting->tissue = PaintedTissue::Chosen;
  test.editor->selection->tissues = {143};
  test.stroke(test.at(0, 20), test.at(5, 20));
  int skin = 0, others = 0;
  const Document& document = test.editor->document();
  test.for_each([&](const glm::dvec3& p, const glm::ivec3& voxel, const Influence& i) {
    if (p.z < 0 || i.of(1) == 0) return;
    (document.volume->at(voxel) == 143 ? skin : others) += 1;
  });
  CHECK(skin > 10);
  CHECK(others == 0);
}

TEST_CASE("painting: tissue that is hidden is not painted unless all tissue is asked for") {
  for (const bool all : {false, true}) {
    PaintEditor test;
    show_tissues(*test.editor, {17}, false);
    test.play("wait-idle");
    if (all) test.play("click \"Edit/Brush reach/All tissue\"");
    const auto before = test.editor->document().weights;
    test.stroke(test.at(0, 12), test.at(20, 12));
    test.play("wait-idle");
    REQUIRE(test.editor->document().weights != before);
    int hidden = 0, shown = 0;
    test.for_each([&](const glm::dvec3& p, const glm::ivec3& voxel, const Influence& influence) {
      if (p.z < 0 || influence.of(1) == 0) return;
      (test.editor->document().volume->at(voxel) == 17 ? hidden : shown) += 1;
    });
    CHECK(shown > 20);
    CHECK((hidden > 0) == all);
  }
}
