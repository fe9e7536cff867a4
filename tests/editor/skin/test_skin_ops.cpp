// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that show skin weights, select their bones, and lock them.
#include "core/skin/skin_weights.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/files/project_session.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

using Effect = std::function<bool(Stage&, const Seen&)>;

// Returns weights of the ball that follow Upper above and Fore below, with a blend of 24 mm between.
std::shared_ptr<const SkinWeights> blended_weights(const Document& document) {
  const LabelVolume& volume = *document.volume;
  const TissueVoxels tissue(volume);
  const AffineTransform world = world_from_voxel(volume.grid);
  SkinWeights weights({"Upper", "Fore"}, tissue);
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
    SkinWeights::Influences chunk = weights.chunk(b);
    tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
      const double fore = glm::clamp(0.5 - (world * glm::dvec3(voxel)).z / 24, 0.0, 1.0);
      chunk[place - tissue.bricks()[b].first] = quantize({{0, 1 - fore}, {1, fore}});
    });
    weights.set_chunk(b, chunk);
  }
  return std::make_shared<const SkinWeights>(weights);
}

void weigh(Context& editor) {
  Document next = editor.document();
  next.weights = blended_weights(next);
  editor.history->commit("Weights", next);
  *editor.selection = {};
  editor.selection->bone = 1;
  editor.selection->bones = {1};
}

// Opens the Skin workspace with weights, and moves the pointer over the body's upper half.
void ready(Stage& s) {
  if (!s.document().weights) weigh(s.editor());
  s.play("key Ctrl+2\n move \"3D view/view\"\n wait-idle");
}

// Selects the bone that the pointer is not over.
void choose_other(Stage& s) {
  s.editor().skin->searching = false;
  ready(s);
  const auto over = s.document().armature->find(s.editor().views->hover.weights.at(0).bone);
  s.editor().selection->bone = 1 - *over;
  s.editor().selection->bones = {1 - *over};
}

Effect shows(const char* display) {
  return [=](Stage& s, const Seen&) { return s.is("weights", display); };
}
Effect locked(std::set<std::string> bones, const char* edit) {
  return [=](Stage& s, const Seen& before) {
    return (s.document().locks ? s.document().locks->bones : std::set<std::string>{}) == bones && s.is("edit", edit) &&
           static_cast<int>(s.editor().history->position()) == before.position + 1;
  };
}
Effect popup(const char* name) {
  return [=](Stage& s, const Seen&) { return s.editor().menus->shown_popup == name; };
}
Effect hidden(std::set<std::string> bones) {
  return [=](Stage& s, const Seen&) { return s.editor().skin->hidden == bones; };
}

struct SkinEditor : LimbEditor {
  explicit SkinEditor(const glm::ivec2& size = {1280, 720}) : LimbEditor(size) {
    weigh(*editor);
    play("key Ctrl+2\n wait-idle");
  }
};

}  // namespace

std::vector<Proof> proofs_of_skin() {
  return {
      {"skin.show_dominant", "click \"header/Weight display\"\n click \"header/Weight display/Dominant bones\"",
       shows("dominant"), Shows::InBody, "", ready},
      {"skin.show_mixed", "key D\n click \"All influences\"", shows("mixed"), Shows::InBody},
      {"skin.show_count", "click \"View/Weights/Number of influences\"", shows("count"), Shows::InSlice},
      {"skin.show_tissues", "click \"View/Weights/Tissues\"", shows("none"), Shows::InSlice},
      {"skin.show_active", "click \"View/Weights/Active bone\"", shows("active"), Shows::InBody},
      {"skin.contours", "click \"View/Weights/Contours\"",
       [](Stage& s, const Seen&) { return !s.editor().skin->contours; }, Shows::InBody},
      {"skin.display_pie", "key D", popup("Weight display"), Shows::Nothing, "", ready},
      {"skin.lock_pie", "key K", popup("Locks"), Shows::Nothing, "", ready},
      {"skin.lock", "key K\n click \"Lock bone\"", locked({"Fore"}, "Lock Fore"), Shows::Nothing, "", ready},
      {"skin.lock_others", "click \"Bones/skin.lock_others\"", locked({"Upper"}, "Lock all but Fore")},
      {"skin.invert_locks", "click \"Edit/Weights/Invert locks\"", locked({"Fore"}, "Invert locks")},
      {"skin.lock_all", "click \"Edit/Weights/Lock all bones\"", locked({"Fore", "Upper"}, "Lock all bones")},
      {"skin.unlock_all", "click \"Edit/Weights/Unlock all bones\"", locked({}, "Unlock all bones")},
      {"skin.isolate_region", "click \"View/Weights/Isolate region\"", hidden({"Upper"}), Shows::InBody},
      {"skin.reveal_regions", "click \"View/Weights/Reveal regions\"", hidden({}), Shows::InSlice},
      {"skin.hide_region", "click \"View/Weights/Hide region\"", hidden({"Fore"}), Shows::InBody},
      {"skin.find_bone", "click \"Bones/search bones\"\n type \"upp\"",
       [](Stage& s, const Seen&) {
         return s.editor().skin->search == "upp" && s.is("widget:Bones/Upper/name") &&
                s.is("widget:Bones/Fore/name", "absent");
       },
       Shows::Nothing, "", [](Stage& s) { s.editor().skin->hidden.clear(); }},
      {"skin.pick_bone", "click \"3D view/view\" Alt",
       [](Stage& s, const Seen& before) {
         return before.selection.bone && s.editor().selection->bone &&
                s.is("bone", s.editor().views->hover.weights.empty() ? "" : s.editor().views->hover.weights[0].bone);
       },
       Shows::Nothing, "", choose_other},
      {"skin.add_bone", "click \"3D view/view\" Shift Alt",
       [](Stage& s, const Seen&) {
         return s.editor().selection->bones == std::set<int>{0, 1};
       },
       Shows::Nothing, "", choose_other},
  };
}

TEST_CASE("operators: weights are shown, bones picked by them, locked and isolated") {
  Stage stage;
  prove(stage, proofs_of_skin());
}

TEST_CASE("skin: the Skin workspace shows the active bone's ramp at once, and the tissues elsewhere") {
  SkinEditor test;
  CHECK(test.fact("weights") == "active");
  CHECK(test.fact("bone") == "Fore");
  CHECK(test.fact("text:Weight of Fore") == "shown");
  CHECK(test.fact("text:exactly 0") == "shown");
  CHECK(test.fact("text:Active bone weight") == "shown");
  test.play("key Ctrl+3\n wait-idle");
  CHECK(test.fact("weights") == "none");
  CHECK(test.fact("text:Weight of Fore") == "absent");
}

TEST_CASE("skin: without weights the list of bones offers them, and a click computes them") {
  LimbEditor test;
  test.play("key Ctrl+2\n wait-idle");
  CHECK(test.fact("text:No weights yet") == "shown");
  CHECK(test.fact("weights") == "none");
  test.play("click \"Bones/Heat diffusion\"\n wait-job\n wait-idle");
  CHECK(test.fact("weights") == "active");
  CHECK(test.fact("text:No weights yet") == "absent");
}

TEST_CASE("skin: a row of the list makes a bone active, shows its share, and its lock is undone and redone") {
  SkinEditor test;
  const auto share = [&](const std::string& bone) {
    return *test.editor->skin->shares.of(weights_bone(*test.editor->document().weights, bone));
  };
  CHECK(share("Upper") + share("Fore") == doctest::Approx(1));
  CHECK(share("Fore") == doctest::Approx(0.5).epsilon(0.1));
  test.play("click Bones/Upper/name\n wait-idle");
  CHECK(test.fact("bone") == "Upper");
  CHECK(test.fact("text:Weight of Upper") == "shown");

  test.play("click Bones/Fore/lock\n wait-idle");
  CHECK(test.editor->document().locks->bones == std::set<std::string>{"Fore"});
  test.play("key Ctrl+Z");
  CHECK(test.fact("locked") == "0");
  test.play("key Ctrl+Shift+Z");
  CHECK(test.fact("locked") == "1");
  test.play("key Ctrl+Z\n click Bones/Upper/lock Ctrl");
  CHECK(test.fact("edit") == "Lock all but Upper");
  CHECK(test.editor->document().locks->bones == std::set<std::string>{"Fore"});
}

TEST_CASE("skin: shares follow weights that change in some bricks alone") {
  SkinEditor test;
  Document next = test.editor->document();
  SkinWeights changed = *next.weights;
  SkinWeights::Influences chunk = changed.chunk(3);
  for (Influence& influence : chunk) influence = rigid_influence(1);
  changed.set_chunk(3, chunk);
  next.weights = std::make_shared<const SkinWeights>(changed);
  test.editor->history->commit("Paint", next);
  test.play("wait-idle");
  double sum = 0;
  for (std::int64_t b = 0; b < changed.chunk_count(); ++b)
    for (const Influence& influence : changed.chunk(b)) sum += influence.of(1);
  CHECK(*test.editor->skin->shares.of(1) == doctest::Approx(sum / double(changed.size())).epsilon(1e-9));
}

TEST_CASE("skin: the weights under the pointer stand beside it with their sum, tissue and depth, in 3D and in slices") {
  SkinEditor test;
  for (const char* view : {"3D view/view", "Sagittal/view"}) {
    test.play("move \"" + std::string(view) + "\"\n wait-idle");
    CAPTURE(view);
    const Hover& hover = test.editor->views->hover;
    REQUIRE(!hover.weights.empty());
    const auto weights = weights_at(*test.editor->views, test.editor->document(), hover.voxel);
    char value[16];
    std::snprintf(value, sizeof value, "%.3f", weights[0].value);
    CHECK(test.fact(std::string("text:") + value) == "shown");
    CHECK(test.fact("text:Sum") == "shown");
    CHECK(test.fact("text:1.000") == "shown");
  }
  // The depth at the middle of the ball is its radius.
  const LabelVolume& volume = *test.editor->document().volume;
  const glm::ivec3 middle(glm::round(voxel_from_world(volume.grid) * glm::dvec3(0)));
  CHECK(depth_of(volume, middle) == doctest::Approx(38).epsilon(0.1));
  CHECK(test.fact("text:mm deep") == "shown");
  test.play("move \"Bones/Fore/name\"\n wait-idle");
  CHECK(test.fact("text:Sum") == "absent");
}

TEST_CASE("skin: the sum of the weights beside the pointer is as bright in the light theme as in the dark one") {
  SkinEditor test;
  test.play("move \"3D view/view\"\n wait-idle");
  const Rect view = *test.editor->screen->layout.place_of(ViewId::Body);
  const auto bright = [&] {
    const render::Image picture = test.host->picture();
    int count = 0;
    for (int y = int(view.low.y); y < int(view.high.y); ++y)
      for (int x = int(view.low.x); x < int(view.high.x); ++x) {
        const std::uint8_t* pixel = &picture.rgba[4 * (std::size_t(y) * picture.size.x + x)];
        const Colour ok = kViewOk;
        count += std::abs(pixel[0] - int(ok & 255)) + std::abs(pixel[1] - int(ok >> 8 & 255)) +
                     std::abs(pixel[2] - int(ok >> 16 & 255)) <
                 40;
      }
    return count;
  };
  const int in_dark = bright();
  CHECK(in_dark > 5);
  run(*test.editor, "edit.other_theme");
  test.play("wait-idle");
  CHECK(test.editor->ui->look.theme.name == "Light");
  CHECK(bright() > in_dark / 2);
}

TEST_CASE("skin: depth is the distance to the nearest air, as a search over all voxels finds it") {
  const Document document = small_body();
  const LabelVolume& volume = *document.volume;
  const Grid& grid = volume.grid;
  for (const glm::ivec3& voxel :
       {glm::ivec3(12, 10, 15), glm::ivec3(8, 9, 12), glm::ivec3(12, 4, 15), glm::ivec3(15, 12, 20)}) {
    if (volume.at(voxel) == 0) continue;
    double nearest = 1e300;
    for (int z = -1; z <= grid.size.z; ++z)
      for (int y = -1; y <= grid.size.y; ++y)
        for (int x = -1; x <= grid.size.x; ++x)
          if (volume.at_or_air({x, y, z}) == 0)
            nearest = std::min(nearest, glm::length(glm::dvec3(glm::ivec3(x, y, z) - voxel) * grid.spacing));
    CHECK(depth_of(volume, voxel) == doctest::Approx(nearest - 1.5));
  }
}

TEST_CASE("skin: Alt and a click take the bone that has most of the place, Shift adds it, in slices too") {
  SkinEditor test;
  for (const char* view : {"3D view/view", "Sagittal/view"}) {
    test.play("move \"" + std::string(view) + "\"\n wait-idle");
    const std::string over = test.editor->views->hover.weights.at(0).bone, other = over == "Upper" ? "Fore" : "Upper";
    test.play("click Bones/" + other + "/name\n wait-idle\n click \"" + view + "\" Alt\n wait-idle");
    CHECK(test.fact("bone") == over);
    CHECK(test.editor->selection->bones.size() == 1);
    test.play("click Bones/" + other + "/name\n wait-idle\n click \"" + view + "\" Shift Alt\n wait-idle");
    CHECK(test.fact("bone") == over);
    CHECK(test.editor->selection->bones.size() == 2);
  }
}

TEST_CASE("skin: an isolated region is all that rays, slices and the pointer find, and comes back whole") {
  SkinEditor test;
  const auto tissue_shown = [&] {
    const auto& voxels = test.editor->views->scene.volume->voxels;
    return std::count_if(voxels.begin(), voxels.end(), [](Label label) { return label != 0; });
  };
  const auto all = tissue_shown();
  test.play("click Bones/Fore/eye Ctrl\n wait-idle");
  std::int64_t fore = 0;
  const SkinWeights& weights = *test.editor->document().weights;
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b)
    for (const Influence& influence : weights.chunk(b)) fore += influence.bone[0] == 1;
  CHECK(tissue_shown() == fore);
  CHECK(fore < all);
  CHECK(test.fact("weights") == "active");
  // Weight edits change which voxels are shown. With edited_at_once = 0, this is computed in the background.
  const auto shown_of_large = [&](std::int64_t at_once) {
    test.editor->skin->painting->edited_at_once = at_once;
    Document next = test.editor->document();
    SkinWeights other = *next.weights;
    SkinWeights::Influences chunk(other.chunk(0).size(), rigid_influence(other.chunk(0)[0].bone[0] == 1 ? 0 : 1));
    other.set_chunk(0, chunk);
    next.weights = std::make_shared<const SkinWeights>(other);
    test.editor->history->commit("One brick", next);
    test.play("wait-idle");
    std::int64_t count = 0;
    for (std::int64_t b = 0; b < other.chunk_count(); ++b)
      for (const Influence& influence : other.chunk(b)) count += influence.bone[0] == 1;
    CHECK(tissue_shown() == count);
  };
  shown_of_large(1'000'000);
  shown_of_large(0);
  test.play("key Ctrl+Z\n key Ctrl+Z\n wait-idle");
  CHECK(tissue_shown() == fore);
  test.play("click Bones/Fore/eye Ctrl\n wait-idle");
  CHECK(tissue_shown() == all);
  test.play("click Bones/Upper/eye\n wait-idle");
  CHECK(tissue_shown() == fore);
}

TEST_CASE("skin: saved and opened again, bones are locked and the display is as it was") {
  const Home home;
  {
    Sitting sitting(home.folder.path());
    auto opened = std::make_shared<Opened>();
    opened->document = small_limb();
    opened->name = "limb";
    opened->label = "Open limb";
    replace_project(sitting.editor(), opened);
    sitting.test.player.settle();
    weigh(sitting.editor());
    sitting.play(
        "key Ctrl+2\n wait-idle\n move \"3D view/view\"\n key D\n click \"Dominant bones\"\n click "
        "View/Weights/Contours\n click Bones/Fore/lock\n wait-idle");
    CHECK(sitting.test.fact("locked") == "1");
    sitting.play("key Ctrl+S\n type limb\n key Return\n wait-job\n expect unsaved no\n expect name limb.limber");
  }
  Sitting sitting(home.folder.path(), {home / "limb.limber"});
  sitting.play("wait-job\n wait-idle");
  CHECK(sitting.editor().document().locks->bones == std::set<std::string>{"Fore"});
  CHECK(sitting.editor().skin->display == render::WeightDisplay::Dominant);
  CHECK(!sitting.editor().skin->contours);
  CHECK(sitting.test.fact("weights") == "dominant");
}

}  // namespace limber::test
