// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/skin/label_strokes.h"
#include "editor/ui/ui.h"

#include "core/project/project_io.h"
#include "editor/context/view_projection.h"
#include "editor/labels/label_edits.h"
#include "editor/seams/seam_view.h"
#include "editor/skin/weight_display.h"
#include "editor/volume/shown_image.h"
#include "render/passes/pass_resources.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

using namespace editor;

namespace {

LabelBrush& brush_of(Context& editor) { return *editor.skin->painting->labels; }

void select(Context& editor, Label label) {
  editor.selection->tissue = label;
  editor.selection->tissues = {label};
}

// Shows a grey image on the ball's grid: 1000 in its left half, 0 in the other.
void show_halves(Context& editor) {
  const Grid& grid = editor.document().volume->grid;
  std::vector<float> values(static_cast<std::size_t>(grid.voxel_count()));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>(i) % grid.size.x < 12 ? 1000.0f : 0.0f;
  show_image(editor, usually_shown(std::make_shared<const GreyLevels>(grey_levels(grid, values))), "image.nrrd");
}

// The ball in four views of the Skin workspace, with the label brush set to bone.
struct LabelEditor : LimbEditor {
  LabelEditor() : LimbEditor({1120, 620}) {
    select(*editor, 111);
    play("key Ctrl+2\nkey Ctrl+Alt+Q\nwait-idle\nclick strip/labels.brush\nmove Axial/view\nwait-idle");
    editor->skin->painting->radius = 11;
    before = editor->document();
  }
  // Returns the position of a world point in a view, as scripts write it.
  std::string at(ViewId id, const glm::dvec3& point) {
    for (const ViewPlace& place : editor->screen->layout.view_places)
      if (place.id == id) {
        const glm::dvec2 pixel =
            ViewProjection(*editor, place).pixel_of(point).value() / double(editor->ui->look.scale);
        char line[80];
        std::snprintf(line, sizeof line, "move %.4f %.4f\n", pixel.x, pixel.y);
        return line;
      }
    return "";
  }
  void stroke(ViewId id, const glm::dvec3& from, const glm::dvec3& to, const std::string& modifier = "") {
    if (!modifier.empty()) play("key-down " + modifier);
    play(at(id, from) + "wait-idle\npress\nwait-idle\n" + at(id, to) + "wait-idle\nrelease\nwait-idle");
    if (!modifier.empty()) play("key-up " + modifier);
  }
  const LabelVolume& volume() const { return *editor->document().volume; }
  // Calls body(voxel, world) for each voxel.
  template <class Body>
  void for_each(const Body& body) const {
    const Grid& grid = volume().grid;
    const AffineTransform world = world_from_voxel(grid);
    for (int z = 0; z < grid.size.z; ++z)
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) body(glm::ivec3(x, y, z), world * glm::dvec3(x, y, z));
  }
  double plane_of(ViewId id) const { return slice_of(*editor->views, id).camera.centre[id == ViewId::Axial ? 2 : 1]; }

  Document before;
};

double to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double share = glm::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
  return glm::distance(p, a + share * (b - a));
}

}  // namespace

std::vector<Proof> proofs_of_label_brush() {
  const std::string menu = "click \"Edit/Prepare volume/Labels/";
  const auto over = [](PaintOver what) {
    return [what](Stage& s, const Seen&) { return brush_of(s.editor()).over == what; };
  };
  const auto erases = [](Erased what) {
    return [what](Stage& s, const Seen&) { return brush_of(s.editor()).erased == what; };
  };
  return {
      {"labels.brush", "click strip/labels.brush\n wait-idle",
       [](Stage& s, const Seen&) { return brush_of(s.editor()).on && s.is("text:Label brush"); }, Shows::Nothing,
       "key Ctrl+2\n key Ctrl+Alt+Q\n wait-idle", [](Stage& s) { select(s.editor(), 111); }},
      {"labels.over_air", menu + "Paint over air\"", over(PaintOver::Air)},
      {"labels.over_tissue", menu + "Paint over tissue\"", over(PaintOver::Tissue)},
      {"labels.over_underneath", menu + "Paint over one tissue\"", over(PaintOver::Underneath)},
      {"labels.over_all", menu + "Paint over all\"", over(PaintOver::All)},
      {"labels.erase_to_air", menu + "Erase to air\"", erases(Erased::Air)},
      {"labels.erase_to_surroundings", menu + "Erase to surroundings\"", erases(Erased::Surroundings)},
      {"labels.flat", menu + "Only one slice\"", [](Stage& s, const Seen&) { return brush_of(s.editor()).flat; }},
      {"labels.in_range", menu + "Only in a value range\"",
       [](Stage& s, const Seen&) { return brush_of(s.editor()).in_range; }, Shows::Nothing, "",
       [](Stage& s) { show_halves(s.editor()); }},
      {"labels.pick", "move Axial/view\n wait-idle\n key Shift+X\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().selection->tissue == Label(111); }, Shows::Nothing, "",
       [](Stage& s) { select(s.editor(), 143); }},
  };
}

TEST_CASE("operators: the label brush and its settings") {
  Stage stage;
  prove(stage, proofs_of_label_brush());
}

TEST_CASE("label brush: a stroke in a slice paints a capsule, and is one step that undo takes back bit for bit") {
  LabelEditor test;
  const double z = test.plane_of(ViewId::Axial);
  const glm::dvec3 from(-20, -10, z), to(15, 12, z);
  const auto position = test.editor->history->position();
  const int uploads = test.editor->views->renderer.resources().uploads();
  test.stroke(ViewId::Axial, from, to);
  CHECK(test.editor->history->position() == position + 1);
  CHECK(test.fact("edit") == "Paint Cortical bone");
  std::int64_t painted = 0;
  test.for_each([&](const glm::ivec3& v, const glm::dvec3& p) {
    const double away = to_segment(p, from, to);
    if (std::abs(away - 11) < 0.01) return;  // too close to decide: pixel positions are rounded
    painted += away < 11;
    CHECK(test.volume().at(v) == (away < 11 ? 111 : test.before.volume->at(v)));
  });
  CHECK(painted > 200);
  const LabelVolume after = test.volume();
  test.play("key Ctrl+Z\nwait-idle");
  // Only the changed part of the textures was updated; nothing was uploaded again.
  CHECK(test.editor->views->renderer.resources().uploads() == uploads);
  CHECK(test.volume().voxels == test.before.volume->voxels);
  CHECK(test.editor->history->position() == position);
  test.play("key Ctrl+Shift+Z\nwait-idle");
  CHECK(test.volume().voxels == after.voxels);
}

TEST_CASE("label brush: with Ctrl it erases to the surroundings or to air, Escape drops a stroke") {
  LabelEditor test;
  const double z = test.plane_of(ViewId::Axial);
  const auto position = test.editor->history->position();
  test.stroke(ViewId::Axial, {9, 0, z}, {20, 0, z}, "Ctrl");
  CHECK(test.fact("edit") == "Erase Cortical bone");
  std::int64_t erased = 0;
  test.for_each([&](const glm::ivec3& v, const glm::dvec3& p) {
    const Label was = test.before.volume->at(v);
    const double away = to_segment(p, {9, 0, z}, {20, 0, z});
    const bool inside = was == 111 && away < 11;
    erased += inside;
    if (std::abs(away - 11) > 0.01) CHECK(test.volume().at(v) == (inside ? 17 : was));
  });
  CHECK(erased > 20);
  test.play("key Ctrl+Z\nwait-idle");
  run(*test.editor, "labels.erase_to_air");
  test.stroke(ViewId::Axial, {9, 0, z}, {20, 0, z}, "Ctrl");
  std::int64_t air = 0;
  test.for_each(
      [&](const glm::ivec3& v, const glm::dvec3&) { air += test.before.volume->at(v) && !test.volume().at(v); });
  CHECK(air == erased);
  test.play("key Ctrl+Z\nwait-idle");

  test.play(test.at(ViewId::Axial, {0, 20, z}) +
            "wait-idle\npress\nwait-idle\nkey Escape\nwait-idle\nrelease\nwait-idle");
  CHECK(test.editor->history->position() == position);
  CHECK(test.volume().voxels == test.before.volume->voxels);
  CHECK(test.editor->views->scene.volume == test.editor->document().volume);
}

TEST_CASE("label brush: it paints over what it may, in one slice, and in a range of the image's values") {
  LabelEditor test;
  const double z = test.plane_of(ViewId::Axial);
  const glm::dvec3 middle(0, 0, z);
  test.editor->skin->painting->radius = 38;
  const auto over = [&](const char* id, const std::function<bool(Label)>& may) {
    run(*test.editor, id);
    const glm::dvec3 at(0, 16, z);  // a point in muscle
    test.stroke(ViewId::Axial, at, at + glm::dvec3(0.5, 0, 0));
    std::int64_t changed = 0;
    test.for_each([&](const glm::ivec3& v, const glm::dvec3& p) {
      const Label was = test.before.volume->at(v);
      const double away = to_segment(p, at, at + glm::dvec3(0.5, 0, 0));
      if (std::abs(away - 38) < 0.01) return;
      CHECK(test.volume().at(v) == (away < 38 && may(was) ? 111 : was));
      changed += test.volume().at(v) != was;
    });
    CHECK(changed > 100);
    test.play("key Ctrl+Z\nwait-idle");
  };
  over("labels.over_air", [](Label label) { return label == 0; });
  over("labels.over_tissue", [](Label label) { return label != 0; });
  over("labels.over_underneath", [](Label label) { return label == 17; });
  run(*test.editor, "labels.over_all");

  show_halves(*test.editor);
  run(*test.editor, "labels.in_range");
  LabelBrush& brush = *test.editor->skin->painting->labels;
  const GreyLevels& image = *test.editor->views->image->image;
  // The image is no CT, so the brush starts with the image's whole range of values instead of the range of bone in a
  // CT.
  CHECK_FALSE(looks_like_ct(image));
  CHECK(brush.low == image.least);
  CHECK(brush.high == image.most());
  brush.low = LabelBrush().low;
  brush.high = LabelBrush().high;
  run(*test.editor, "labels.flat");
  test.editor->skin->painting->radius = 25;
  test.stroke(ViewId::Axial, middle, middle + glm::dvec3(1, 0, 0));
  const int layer = static_cast<int>(std::floor((voxel_from_world(test.volume().grid) * middle).z + 0.5));
  std::int64_t changed = 0;
  test.for_each([&](const glm::ivec3& v, const glm::dvec3&) {
    if (test.volume().at(v) == test.before.volume->at(v)) return;
    ++changed;
    CHECK(v.z == layer);
    CHECK(v.x < 12);
  });
  CHECK(changed > 20);
}

TEST_CASE("label brush: on the body's surface it paints a ball around the point under the pointer") {
  LabelEditor test;
  const auto point = [&] {
    test.play("move \"3D view/view\"\nwait-idle");
    REQUIRE(test.editor->skin->painting->place);
    return test.editor->skin->painting->place->rest;
  }();
  CHECK(std::abs(glm::length(point) - 40) < 5);  // mm: on the skin
  test.play("press\nwait-idle\nrelease\nwait-idle");
  CHECK(test.fact("edit") == "Paint Cortical bone");
  std::int64_t painted = 0;
  test.for_each([&](const glm::ivec3& v, const glm::dvec3& p) {
    const double away = glm::distance(p, point);
    if (std::abs(away - 11) < 1e-6) return;
    CHECK(test.volume().at(v) == (away < 11 ? 111 : test.before.volume->at(v)));
    painted += away < 11;
  });
  CHECK(painted > 40);
}

TEST_CASE("label brush: a bare image is painted from nothing, with a new tissue") {
  LimbEditor test;
  Document empty;
  auto air = std::make_shared<LabelVolume>();
  air->grid = test.editor->document().volume->grid;
  air->voxels.resize(static_cast<std::size_t>(air->grid.voxel_count()));
  empty.volume = air;
  empty.tissues = std::make_shared<const TissueTable>();
  empty.volume_type = std::make_shared<const FileType>();
  test.editor->history->reset(empty, "Bare");
  test.play(
      "key Ctrl+2\nkey Ctrl+Alt+Q\nwait-idle\nclick strip/labels.brush\nwait-idle\n"
      "click \"Edit/Prepare volume/Labels/New tissue\"\nmove Axial/view\nwait-idle\npress\nwait-idle\nrelease\n"
      "wait-idle\nexpect edit \"Paint New tissue\"\nexpect error none");
  const Label label = test.editor->document().tissues->tissues.front().label;
  const auto& voxels = test.editor->document().volume->voxels;
  CHECK(std::count(voxels.begin(), voxels.end(), label) > 50);
}

TEST_CASE("label brush: what was painted is in the project's file, with the new tissue, and undo goes on from there") {
  const TemporaryFolder folder;
  LabelEditor test;
  const double z = test.plane_of(ViewId::Axial);
  run(*test.editor, "labels.new_tissue");
  test.stroke(ViewId::Axial, {0, 0, z}, {10, 5, z});
  const Label label = *test.editor->selection->tissue;
  CHECK(std::count(test.volume().voxels.begin(), test.volume().voxels.end(), label) > 50);
  const Path path = folder / "painted.limber";
  DocumentWriter writer;
  create_project({.document = test.editor->document()}, path, writer);
  const Document read = read_project(path).document;
  CHECK(read.volume->voxels == test.volume().voxels);
  REQUIRE(read.tissues->find(label));
  CHECK(read.tissues->find(label)->name == "New tissue");
  test.play("key Ctrl+Z\nkey Ctrl+Z\nwait-idle");
  CHECK(test.volume().voxels == test.before.volume->voxels);
  CHECK_FALSE(test.editor->document().tissues->find(label));
}

TEST_CASE("label brush: run from another workspace it leads to the Skin workspace and is on there") {
  LimbEditor test({1120, 620});
  select(*test.editor, 111);
  test.play("key Ctrl+1\nwait-idle\nkey F3\nwait-idle\ntype \"label brush\"\nwait-idle\nkey Return\nwait-idle");
  CHECK(test.editor->workspace() == Workspace::Skin);
  CHECK(brush_of(*test.editor).on);
  test.play("key Ctrl+3\nwait-idle");
  CHECK_FALSE(find_operator(test.editor->operators, "labels.brush")->checked(*test.editor));
  // The brush is on but not visible in this workspace, so the command shows it instead of switching it off.
  run(*test.editor, "labels.brush");
  CHECK(test.editor->workspace() == Workspace::Skin);
  CHECK(brush_of(*test.editor).on);
  run(*test.editor, "labels.brush");
  CHECK_FALSE(brush_of(*test.editor).on);
}

TEST_CASE("label brush: without a tissue it says what to do, and other brushes take over from it") {
  LabelEditor test;
  *test.editor->selection = {};
  test.play("move Axial/view\nwait-idle\npress\nrelease\nwait-idle");
  CHECK(test.editor->messages->toasts.back().detail.find("Select a tissue") != std::string::npos);
  run(*test.editor, "skin.seam_brush");
  test.play("wait-idle");
  CHECK_FALSE(brush_of(*test.editor).on);
  CHECK(test.editor->seams->brush);
  run(*test.editor, "labels.brush");
  test.play("wait-idle");
  CHECK(brush_of(*test.editor).on);
  CHECK_FALSE(test.editor->seams->brush);
  run(*test.editor, "skin.brush_add");
  CHECK_FALSE(brush_of(*test.editor).on);
}

TEST_CASE(
    "label brush: weights go with a warning when a stroke changes which voxels are tissue, and undo returns them") {
  LabelEditor test;
  Document next = test.editor->document();
  next.weights = half_weights(*next.volume);
  test.editor->history->commit("Weigh", next);
  const double z = test.plane_of(ViewId::Axial);
  test.stroke(ViewId::Axial, {0, 0, z}, {10, 0, z});  // paints bone over muscle
  CHECK(test.editor->document().weights == next.weights);
  run(*test.editor, "labels.erase_to_air");
  test.stroke(ViewId::Axial, {0, 0, z}, {5, 0, z}, "Ctrl");
  CHECK_FALSE(test.editor->document().weights);
  CHECK(test.editor->messages->toasts.back().detail.find("weights") != std::string::npos);
  test.play("key Ctrl+Z\nwait-idle");
  CHECK(test.editor->document().weights == next.weights);
}

}  // namespace limber::test
