// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares pictures of the whole window with pictures that were looked at and approved: tests/editor/golden/NAME.png.
//
// The stored pictures have half the window's size and colours in steps of four, which is finer than the comparison:
// both pictures are blurred by 3 x 3 pixels, then the mean difference and the share of pixels that clearly differ must
// be below limits. Drivers round differently at edges, so single pixels prove nothing.
//
// A failure writes NAME.png and NAME-difference.png into the folder that $LIMBER_GOLDEN_FAILURES names (else
// golden-failures, in the folder in which the test runs). After an intended change, run this and look at each picture
// that changed:
//   LIMBER_GOLDEN_REFRESH=1 build/tests/limber_editor_tests -tc="golden:*"
// To see the scenes in another window without comparing them, run this; it writes NAME-2048x1280@2.png into the current
// folder:
//   LIMBER_SCENES=2048x1280@2 build/tests/limber_editor_tests -tc="golden:*"
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>

#include "core/binding/heat_diffusion.h"
#include "core/phantom/phantom.h"
#include "editor/context/background_task.h"
#include "editor/context/selection.h"
#include "editor/files/export_figure.h"
#include "editor/files/project_session.h"
#include "editor/motion/graph.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"
#include "tests/editor/sitting.h"

namespace limber::test {

using namespace editor;
using render::Image;

namespace {

constexpr glm::ivec2 kWindow{1280, 720};
constexpr double kMostMean = 1.2;     // a larger mean difference fails, 0 to 255
constexpr double kClearly = 20;       // a pixel clearly differs if a channel differs by more, 0 to 255
constexpr double kMostClear = 0.004;  // a larger share of clearly differing pixels fails

int channel(const Image& image, int x, int y, int c) {
  return image.rgba[(static_cast<std::size_t>(y) * image.size.x + x) * 4 + c];
}

Image halved(const Image& image) {
  Image half{image.size / 2, {}};
  half.rgba.reserve(static_cast<std::size_t>(half.size.x) * half.size.y * 4);
  for (int y = 0; y < half.size.y; ++y)
    for (int x = 0; x < half.size.x; ++x)
      for (int c = 0; c < 4; ++c) {
        const int sum = channel(image, 2 * x, 2 * y, c) + channel(image, 2 * x + 1, 2 * y, c) +
                        channel(image, 2 * x, 2 * y + 1, c) + channel(image, 2 * x + 1, 2 * y + 1, c);
        half.rgba.push_back(static_cast<std::uint8_t>(c == 3 ? 255 : std::min(255, (sum / 4 + 2) / 4 * 4)));
      }
  return half;
}

double blurred(const Image& image, int x, int y, int c) {
  int sum = 0, count = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.size.y - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, image.size.x - 1); ++u, ++count)
      sum += channel(image, u, v, c);
  return static_cast<double>(sum) / count;
}

struct Comparison {
  // The mean difference of the blurred pictures (0 to 255), and the share of pixels that differ by more than kClearly.
  double mean = 255, clear = 1;
  Image difference;

  bool same() const { return mean <= kMostMean && clear <= kMostClear; }
};

Comparison compare(const Image& a, const Image& b) {
  if (a.size != b.size) return {};
  Comparison result{0, 0, {a.size, std::vector<std::uint8_t>(a.rgba.size(), 255)}};
  const double pixels = static_cast<double>(a.size.x) * a.size.y;
  for (int y = 0; y < a.size.y; ++y)
    for (int x = 0; x < a.size.x; ++x) {
      double most = 0;
      for (int c = 0; c < 3; ++c) {
        const double difference = std::abs(blurred(a, x, y, c) - blurred(b, x, y, c));
        result.mean += difference / 3 / pixels;
        most = std::max(most, difference);
        result.difference.rgba[(static_cast<std::size_t>(y) * a.size.x + x) * 4 + c] =
            static_cast<std::uint8_t>(std::min(255.0, 4 * difference));
      }
      result.clear += most > kClearly ? 1 / pixels : 0;
    }
  return result;
}

std::filesystem::path golden(const std::string& name) {
  return std::filesystem::path(LIMBER_SOURCE_DIR "/tests/editor/golden") / (name + ".png");
}

// The size and scale of the window that $LIMBER_SCENES asks for.
struct Window {
  glm::ivec2 size = kWindow;
  float scale = 1;
};
std::optional<Window> wanted_window() {
  Window window;
  const char* named = std::getenv("LIMBER_SCENES");
  return named && std::sscanf(named, "%dx%d@%f", &window.size.x, &window.size.y, &window.scale) >= 2
             ? std::optional(window)
             : std::nullopt;
}

void check_golden(const std::string& name, const Image& window) {
  if (wanted_window()) return render::write_png(window, name + "-" + std::getenv("LIMBER_SCENES") + ".png");
  const Image picture = halved(window);
  if (std::getenv("LIMBER_GOLDEN_REFRESH")) render::write_png(picture, golden(name));
  const Comparison found = compare(picture, render::read_png(golden(name)));
  INFO(name, ": mean difference ", found.mean, " of 255, ", 100 * found.clear, " % of the pixels clearly differ");
  CHECK(found.same());
  if (found.same()) return;
  const char* named = std::getenv("LIMBER_GOLDEN_FAILURES");
  const std::filesystem::path folder = std::filesystem::absolute(named ? named : "golden-failures");
  std::filesystem::create_directories(folder);
  render::write_png(picture, folder / (name + ".png"));
  if (!found.difference.rgba.empty()) render::write_png(found.difference, folder / (name + "-difference.png"));
  MESSAGE("see ", folder.string());
}

// An editor session in which nothing moves by itself.
struct Scene {
  explicit Scene(const glm::ivec2& size = kWindow)
      : sitting(home.folder.path(), {}, wanted_window().value_or(Window{size}).size) {
    editor().preferences->reduce_motion = true;
    editor().views->renderer.average_at_rest(6);  // frames averaged at rest, as for users
    // Most pictures use the light of a body that has just moved: they check the window, and would take twice as long
    // otherwise. The light at rest has its own picture, and tests/render/passes/test_light_pass.cpp.
    editor().views->renderer.light_at_rest(render::Light::Draft);
    editor().preferences->scale = wanted_window().value_or(Window{}).scale;
    sitting.play("wait-idle");
  }

  Editor& editor() { return sitting.editor(); }
  void play(const std::string& script) { sitting.play(script); }
  Image picture() {
    play("wait-idle");
    return sitting.test.host->picture();
  }
  void open(Phantom phantom, const std::string& name, const Visibility& visibility = {}) {
    auto opened = std::make_shared<Opened>();
    opened->document.volume = std::make_shared<const LabelVolume>(std::move(phantom.volume));
    opened->document.tissues = std::make_shared<const TissueTable>(std::move(phantom.tissues));
    opened->document.visibility = std::make_shared<const Visibility>(visibility);
    opened->document.volume_type = std::make_shared<const FileType>();
    opened->document.armature = std::make_shared<const Armature>(std::move(phantom.armature));
    opened->name = name;
    opened->label = "Open " + name;
    opened->agreed = editor().history->revision();
    replace_project(editor(), opened);
    sitting.test.player.settle();
  }
  void open_arm() { open(make_arm_phantom(3), "arm"); }

  Home home;
  Sitting sitting;
};

struct Arm : Scene {
  Arm() { open_arm(); }
};

struct Small : Scene {
  Small() : Scene({840, 540}) { open_arm(); }
};

}  // namespace

TEST_CASE("golden: start screen") {
  Scene scene;
  check_golden("start", scene.picture());
}

TEST_CASE("golden: arm, solid") {
  Arm scene;
  check_golden("arm_solid", scene.picture());
}

TEST_CASE("golden: arm, soft shadows at rest") {
  Arm scene;
  scene.editor().views->renderer.light_at_rest(render::Light::Fine);
  check_golden("arm_soft_shadows", scene.picture());
}

TEST_CASE("golden: a figure of the arm cut lengthwise, with soft shadows, outlines on the cut, scale bar and legend") {
  Arm scene;
  scene.editor().views->renderer.light_at_rest(render::Light::Fine);
  scene.editor().views->bones = false;
  scene.play("move \"3D view/view\"\n key Num3");
  Document cut = scene.editor().document();
  Visibility visibility = *cut.visibility;
  visibility.clip_plane = {true, cut.armature->bones[1].head, glm::dvec3(1, 0, 0)};
  cut.visibility = std::make_shared<const Visibility>(visibility);
  scene.editor().history->commit("Cut", cut);
  scene.play("wait-idle");
  render::Camera& camera = scene.editor().views->body.camera;
  camera = zoomed(camera, 0.7);
  FigureOptions options{.size = {100, 120}, .dots_per_inch = 200, .letter = "a", .title = "The arm at rest"};
  export_figure(scene.editor(), options, scene.home / "figure.png");
  scene.play("wait-job");
  check_golden("figure_arm", render::read_png(scene.home / "figure.png"));
}

TEST_CASE("golden: arm, X-ray with bones, one chosen") {
  Arm scene;
  scene.play("move \"3D view/view\"\n key Alt+Z");
  scene.editor().selection->bone = 1;
  scene.editor().selection->bones = {1};
  check_golden("arm_xray", scene.picture());
}

TEST_CASE("golden: arm, bones as cylinders in front, with names and axes") {
  Arm scene;
  scene.play(
      "click View/Bones/Cylinders\n click \"View/Bones/Bone names\"\n click \"View/Bones/Bone axes\"\n click "
      "\"View/Bones/Bones in front\"\n click tool.rotate");
  scene.editor().selection->bone = 1;
  scene.editor().selection->bones = {1};
  check_golden("bones_cylinders", scene.picture());
}

TEST_CASE("golden: arm, bones as sticks in the sidebar's display") {
  Arm scene;
  scene.editor().ui->open_sections["Outliner"] = false;
  scene.editor().ui->open_sections["Tissues"] = false;
  scene.play("key Alt+Z\n click View/Bones/Sticks\n click Display/fold");
  check_golden("bones_sticks", scene.picture());
}

TEST_CASE("golden: arm, a clip box through the elbow") {
  Arm scene;
  scene.play("move \"3D view/view\"\n key Num1\n key Alt+B");
  Document cut = scene.editor().document();
  const glm::dvec3 elbow = cut.armature->bones[1].head;
  Visibility visibility = *cut.visibility;
  visibility.clip_box.low.y = std::round((voxel_from_world(cut.volume->grid) * elbow).y) - 0.5;
  cut.visibility = std::make_shared<const Visibility>(visibility);
  scene.editor().history->commit("Move clip box", cut);
  render::Camera& camera = scene.editor().views->body.camera;
  camera.centre = elbow;
  camera.distance *= 0.45;
  scene.editor().ui->touch();
  check_golden("clip_box", scene.picture());
}

// These pictures are small and show the 3D view only, so they cost little.
TEST_CASE("golden: bones chosen in a box and under a circle") {
  for (const auto& [name, key, end] : {std::tuple{"box_select", "B", "500 340"}, {"circle_select", "C", "430 330"}}) {
    Small scene;
    scene.play(std::string("move \"3D view/view\"\n key Alt+Z\n key Num1\n move 330 150\n key ") + key);
    scene.sitting.test.host->events.push(ButtonChanged{MouseButton::Left, true});
    scene.play(std::string("wait-idle\n move ") + end);
    check_golden(name, scene.picture());
    scene.play("key Escape");
  }
}

TEST_CASE("golden: a limb held by a pin and a pole, at rest and out of reach") {
  Small scene;
  scene.play("key Ctrl+3\n move \"3D view/view\"\n key Alt+Z\n key Num3");
  scene.editor().selection->bone = 1;
  scene.editor().selection->bones = {1};
  scene.play("key Shift+I");
  check_golden("ik_pin_pole", scene.picture());
  scene.play("key G\n key Z\n key -\n key 9\n key 0");
  check_golden("ik_out_of_reach", scene.picture());
  scene.play("key Escape");
}

TEST_CASE("golden: an arm's eased keys as curves, with the handles of one") {
  Arm scene;
  Document next = scene.editor().document();
  Clip clip{.name = "keys", .range_end = 60};
  const std::string& bone = next.armature->bones[1].name;
  for (const auto& [frame, degrees] : {std::pair{0, 0.0}, {20, 80.0}, {34, 55.0}, {60, 10.0}}) {
    clip.keys.bones[bone][frame] = glm::angleAxis(glm::radians(degrees), glm::normalize(glm::dvec3(1, 0.3, -0.2)));
    set_shape(clip.keys, bone, frame, {Interpolation::Bezier, HandleKind::Automatic});
  }
  next.clips = {std::make_shared<const Clip>(clip)};
  scene.editor().history->commit("Keys", next);
  scene.editor().selection->bone = 1;
  scene.editor().selection->bones = {1};
  show_graph(scene.editor(), true);
  scene.play("key Ctrl+3\n wait-idle");
  graph_of(scene.editor()).chosen = {{{{bone, false}, 0}, 20}};
  scene.play("move graph");
  check_golden("graph", scene.picture());
}

// The arm with weights in the Skin workspace, with the forearm active.
struct Weighted : Arm {
  Weighted() {
    Document next = editor().document();
    next.weights = std::make_shared<const SkinWeights>(diffuse_heat(*next.volume, *next.tissues, *next.armature));
    editor().history->commit("Heat diffusion", next);
    editor().selection->bone = 1;
    editor().selection->bones = {1};
    play("key Ctrl+2\n move \"3D view/view\"\n key Num3\n wait-idle");
    render::Camera& camera = editor().views->body.camera;
    camera.centre = next.armature->bones[1].head;
    camera.distance *= 0.5;
    editor().views->cross_hair = camera.centre;
    editor().ui->touch();
  }
};

TEST_CASE("golden: skin weights as a ramp with contours, and what lies under the pointer") {
  Weighted scene;
  check_golden("skin_active", scene.picture());
}

TEST_CASE("golden: skin weights by dominant bones, one of them isolated, with locks") {
  Weighted scene;
  scene.play("key D\n click \"Dominant bones\"\n click Bones/skin.lock_others\n move 700 18");
  check_golden("skin_dominant", scene.picture());
}

TEST_CASE("golden: skin weights, all influences mixed") {
  Weighted scene;
  scene.play("key D\n click \"All influences\"\n move 700 18");
  check_golden("skin_mixed", scene.picture());
}

TEST_CASE("golden: skin weights, the number of influences, on the forearm's region alone") {
  Weighted scene;
  scene.play("key D\n click \"Number of influences\"\n click Bones/list/Forearm/eye Ctrl\n move 700 18");
  check_golden("skin_count", scene.picture());
}

TEST_CASE("golden: arm, four views") {
  Arm scene;
  scene.play("click view.four\n click tool.cross_hair\n drag Coronal/view 0 40\n move \"Axial/view\"");
  check_golden("four_views", scene.picture());
}

TEST_CASE("golden: body with organs") {
  Scene scene;
  Phantom phantom = make_body_phantom(6);
  Visibility visibility;
  for (const Tissue& tissue : phantom.tissues.tissues)
    if (tissue.kind == TissueKind::Skin || tissue.kind == TissueKind::Fat || tissue.kind == TissueKind::Muscle)
      visibility.looks[tissue.label].visible = false;
  scene.open(std::move(phantom), "body", visibility);
  check_golden("body_organs", scene.picture());
}

TEST_CASE("golden: a CT below the labels in the slices, and its bones in 3D") {
  Arm scene;
  const LabelVolume& volume = *scene.editor().document().volume;
  std::vector<float> values;
  for (std::size_t i = 0; i < volume.voxels.size(); ++i) {
    const Tissue* tissue = scene.editor().document().tissues->find(volume.voxels[i]);
    const double density = !tissue ? -1000 : is_bone(tissue->kind) ? 700 : tissue->kind == TissueKind::Fat ? -100 : 50;
    values.push_back(static_cast<float>(density + double(i * 7919 % 41) - 20));
  }
  show_image(scene.editor(), usually_shown(std::make_shared<const GreyLevels>(grey_levels(volume.grid, values))),
             "ct.nrrd");
  scene.play(
      "click view.four\n click view.image_display\n click \"sidebar/sections/Outliner/fold\"\n move \"Axial/view\"");
  check_golden("ct", scene.picture());
}

TEST_CASE("golden: an arm measured, with rulers") {
  Arm scene;
  scene.play(
      "click view.four\n click View/Overlays/Rulers\n click sidebar/sections/Steps/fold\n click "
      "sidebar/sections/Outliner/fold\n click sidebar/sections/Tissues/fold\n click "
      "sidebar/sections/Measurements/fold\n click View/Overlays/Measure/\"Measure girth\"\n click \"3D view/view\"\n "
      "key "
      "Return\n click View/Overlays/Measure/\"Measure thickness\"\n click Coronal/view\n key Return\n click "
      "View/Overlays/Measure/\"Measure angle\"\n click \"3D view/view\"\n click Coronal/view\n move 790 470\n press\n "
      "release\n "
      "key "
      "Return\n wait-idle\n move \"Axial/view\"");
  check_golden("measurements", scene.picture());
}

TEST_CASE("golden: preferences") {
  Arm scene;
  scene.play("key Ctrl+,");
  check_golden("preferences", scene.picture());
}

TEST_CASE("golden: search") {
  Arm scene;
  scene.play("key F3\n type \"clip\"");
  check_golden("search", scene.picture());
}

TEST_CASE("golden: a job at work") {
  Arm scene;
  scene.play("key Ctrl+4\n wait-idle");
  auto end = std::make_shared<std::atomic<bool>>(false);
  start_task(scene.editor(), "Resample Forearm 90\u00b0", [end](Progress& progress) -> Finish {
    progress.update("deform", 0.42);
    while (!*end) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return {};
  });
  for (int i = 0; i < 200 && scene.sitting.test.fact("text:deform") != "shown"; ++i) {
    scene.sitting.test.player.step();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  scene.play("click status/Running\n move \"3D view/view\"");
  check_golden("job", scene.sitting.test.host->picture());
  *end = true;
  scene.play("wait-job");
}

TEST_CASE("golden: an error message") {
  Arm scene;
  scene.editor().messages->show_error(
      "the rig lies outside the volume: /data/limbs/far.json: choose the rig of this volume, or check its units (mm) "
      "and axes (LPS)");
  scene.editor().ui->touch();
  check_golden("error", scene.picture());
}

TEST_CASE("golden: a hidden tissue, another display, a hidden tool strip and another theme are noticed") {
  Arm scene;
  for (const char* change : {"move \"3D view/view\"\n key H", "move \"3D view/view\"\n key Alt+Z", "key T",
                             "key F3\n type \"switch theme\"\n key Return"}) {
    INFO(std::string(change));
    const Image before = halved(scene.picture());
    CHECK(compare(before, halved(scene.picture())).same());
    scene.play(change);
    CHECK_FALSE(compare(before, halved(scene.picture())).same());
  }
}

}  // namespace limber::test
