// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/skin/weight_layers.h"

#include "core/project/project_io.h"
#include "editor/skin/brush_settings.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/paint_editor.h"
#include "tests/support/documents.h"

namespace limber::test {

using namespace editor;

namespace {

const WeightLayers& layers(const PaintEditor& test) { return *test.editor->document().layers; }
bool comes_out(const PaintEditor& test) { return test.weights() == composed(layers(test)); }

std::string dab(const PaintEditor& test) { return test.at(0, 20); }
void stroke(PaintEditor& test, const std::string& at) { test.stroke(at, at); }

// Paints a stroke, and checks that the result equals the preview while the button was down.
void stroke_as_shown(PaintEditor& test, const std::string& at) {
  test.play("move " + at);
  test.press();
  REQUIRE(test.editor->views->preview_weights);
  const SkinWeights seen = *test.editor->views->preview_weights;
  test.release();
  CHECK(test.weights() == seen);
}

// Prepares weights and a brush for layers.
void layer(Stage& s) {
  Document next = s.document();
  next.weights = half_weights(*next.volume);
  s.editor().history->commit("Weigh", next);
  s.editor().selection->bone = 1;
  s.editor().selection->bones = {1};
  s.editor().skin->painting->radius = 25;
  s.editor().skin->painting->strength = 1;
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

std::function<bool(Stage&, const Seen&)> layers_are(std::vector<std::string> names, const char* edit) {
  return [=](Stage& s, const Seen& b) {
    std::vector<std::string> now;
    if (s.document().layers)
      for (const auto& layer : s.document().layers->layers) now.push_back(layer->name);
    return now == names && s.is("edit", edit) && static_cast<int>(s.editor().history->position()) == b.position + 1;
  };
}

}  // namespace

std::vector<Proof> proofs_of_layers() {
  const std::string at_middle = "move \"3D view/view\"\n wait-idle\n ",
                    dab = "press \"3D view/view\"\n release\n wait-idle\n ";
  const auto first_is = [](auto test) {
    return [=](Stage& s, const Seen&) { return s.document().layers && test(*s.document().layers->layers[0]); };
  };
  return {
      {"skin.layer_add", "key Shift+Ctrl+L", layers_are({"Layer 1"}, "Add Layer 1"), Shows::Nothing, "", layer},
      {"skin.layer_show", "click \"Edit weights/Layers/Show layer\"",
       first_is([](const WeightLayer& l) { return !l.visible; }), Shows::InBody, at_middle + dab},
      {"skin.layer_uncover", "click \"Edit weights/Layers/Clear mask\"",
       [](Stage& s, const Seen&) {
         return std::all_of(s.document().layers->layers[0]->mask.begin(), s.document().layers->layers[0]->mask.end(),
                            [](const auto& mask) { return !mask; });
       },
       Shows::InBody, "click \"Edit weights/Layers/Show layer\"\n " + at_middle},
      {"skin.layer_cover", "click \"Edit weights/Layers/Fill mask\"",
       [](Stage& s, const Seen&) {
         return std::all_of(
             s.document().layers->layers[0]->mask.begin(), s.document().layers->layers[0]->mask.end(),
             [](const auto& mask) { return mask && *mask == WeightLayer::Mask(mask->size(), kFullWeight); });
       }},
      {"skin.layer_mask", at_middle + "key Q", [](Stage& s, const Seen&) { return s.editor().skin->painting->mask; }},
      {"skin.layer_rename",
       "click \"Edit weights/Layers/Rename layer\"\n key Ctrl+A\n type \"Elbow\"\n key Return\n wait-idle",
       layers_are({"Elbow"}, "Rename Layer 1"), Shows::Nothing, "",
       [](Stage& s) { s.editor().skin->painting->mask = false; }},
      {"skin.layer_down", "click \"Edit weights/Layers/Lower layer\"",
       layers_are({"Layer 1", "Elbow"}, "Lower Layer 1"), Shows::Nothing, at_middle + "key Shift+Ctrl+L\n"},
      {"skin.layer_up", "click \"Edit weights/Layers/Raise layer\"", layers_are({"Elbow", "Layer 1"}, "Raise Layer 1")},
      {"skin.layer_remove", "click \"Edit weights/Layers/Remove layer\"", layers_are({"Elbow"}, "Remove Layer 1")},
      {"skin.layer_merge", "click \"Edit weights/Layers/Merge down\"", layers_are({}, "Merge Elbow down")},
  };
}

TEST_CASE("operators: weights lie in layers") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_layers());
}

TEST_CASE("layers: a stroke changes the active layer alone, comes out as painted, and is undone with it") {
  std::shared_ptr<const SkinWeights> painted;
  {
    PaintEditor direct;
    stroke(direct, dab(direct));
    painted = direct.editor->document().weights;
  }
  PaintEditor test;
  const auto base = test.editor->document().weights;
  const int steps = test.steps();
  test.play("move \"3D view/view\"\nkey Shift+Ctrl+L\nwait-idle");
  REQUIRE(test.editor->document().layers);
  CHECK(*test.editor->document().weights == *base);
  CHECK(active_layer(*test.editor) == 0);
  stroke_as_shown(test, dab(test));
  CHECK(test.weights() != *base);
  CHECK(layers(test).base == base);
  CHECK(comes_out(test));
  CHECK(test.steps() == steps + 2);
  CHECK(test.weights() == *painted);  // as if painted without layers
  // A second stroke on the layer continues from the first.
  test.editor->skin->painting->kind = BrushKind::Smooth;
  stroke(test, test.at(0, 10));
  CHECK(comes_out(test));
  test.play("key Ctrl+Z\nkey Ctrl+Z\nwait-idle");
  CHECK(test.weights() == *base);
  CHECK(layers(test).layers.size() == 1);
  test.play("key Ctrl+Z\nwait-idle");
  CHECK(!test.editor->document().layers);
  // The active layer no longer exists, so strokes paint the weights themselves.
  stroke(test, test.at(0, 10));
  CHECK(!test.editor->document().layers);
}

TEST_CASE(
    "layers: with normalizing off a stroke takes from below, keeps the layer's other bones, and says when the layer is "
    "full") {
  PaintEditor test;
  test.play("move \"3D view/view\"\nkey Shift+Ctrl+L\nwait-idle");
  run(*test.editor, "skin.normalize_off");
  CHECK(normalize_of(*test.editor) == Normalize::WhenComposed);
  Painting& painting = *test.editor->skin->painting;
  painting.kind = BrushKind::Set;
  painting.value = 0.6;
  const glm::dvec3 centre(0, -std::sqrt(1600 - 400), 20);
  const auto share_at_centre = [&](int bone) {
    double share = -1, nearest = 1e9;
    test.for_each([&](const glm::dvec3& p, const glm::ivec3&, const Influence& i) {
      if (const double off = glm::distance(p, centre); off < nearest) nearest = off, share = i.of(bone);
    });
    return share;
  };
  stroke_as_shown(test, dab(test));
  CHECK(comes_out(test));
  CHECK(share_at_centre(1) == doctest::Approx(0.6).epsilon(1e-3));
  // The other bone gets only the rest that is left in the layer.
  test.choose(0);
  painting.value = 1;
  stroke(test, dab(test));
  CHECK(share_at_centre(1) == doctest::Approx(0.6).epsilon(1e-3));
  CHECK(comes_out(test));
  const int steps = test.steps();
  test.choose(1);
  stroke(test, dab(test));
  CHECK(test.steps() == steps);
  REQUIRE(test.editor->messages->toasts.size() == 1);
  CHECK(test.editor->messages->toasts[0].line == "The layer's weights here already sum to 1");
  // The base has nothing below it, so weights are normalized at once.
  choose_layer(*test.editor, std::nullopt);
  CHECK(normalize_of(*test.editor) == Normalize::Unlocked);
  CHECK(!disabled_reason(*test.editor, *find_operator(test.editor->operators, "skin.normalize_off")).empty());
}

TEST_CASE("layers: the base is painted below a layer, which keeps what it covers") {
  PaintEditor test;
  test.play("move \"3D view/view\"\nkey Shift+Ctrl+L\nwait-idle");
  stroke(test, dab(test));
  const auto covered = layers(test).layers[0];
  const auto base = layers(test).base;
  choose_layer(*test.editor, std::nullopt);
  stroke_as_shown(test, test.at(5, 20));
  CHECK(layers(test).base != base);
  CHECK(*layers(test).base != *base);
  CHECK(layers(test).layers[0]->mask == covered->mask);
  CHECK(comes_out(test));
}

TEST_CASE("layers: opacity, eye and mask are edits in the sidebar, and a hidden layer is not painted") {
  PaintEditor test;
  test.play("key N\nmove \"3D view/view\"\nkey Shift+Ctrl+L\nwait-idle");
  stroke(test, dab(test));
  const SkinWeights full = test.weights();
  test.play("double-click \"sidebar/sections/Layers/layer 0/opacity\"\nkey Ctrl+A\ntype \"40\"\nkey Return\nwait-idle");
  CHECK(layers(test).layers[0]->opacity == doctest::Approx(0.4));
  CHECK(test.last_edit() == "Set opacity of Layer 1");
  CHECK(comes_out(test));
  CHECK(test.weights() != full);

  // Strokes change the mask. Where the layer is taken away, the base shows again, exactly.
  test.play("click \"sidebar/sections/Layers/layer 0/mask\"\nwait-idle");
  CHECK(test.editor->skin->painting->mask);
  test.editor->skin->painting->kind = BrushKind::Subtract;
  test.editor->skin->painting->radius = 40;
  test.play("move " + dab(test));
  test.press();
  REQUIRE(test.editor->views->preview_weights);
  CHECK(*test.editor->views->preview_weights == *layers(test).base);
  test.release();
  CHECK(test.last_edit() == "Subtract mask of Layer 1");
  CHECK(test.weights() == *layers(test).base);
  for (const auto& mask : layers(test).layers[0]->mask) CHECK(!mask);

  const int steps = test.steps();
  test.play("click \"sidebar/sections/Layers/layer 0/eye\"\nwait-idle");
  CHECK(!layers(test).layers[0]->visible);
  stroke(test, dab(test));
  CHECK(test.steps() == steps + 1);
  CHECK(why_not_paint(*test.editor) == "The layer Layer 1 is hidden: show it, or select another layer");
  test.play("click \"sidebar/sections/Layers/base\"\nwait-idle");
  CHECK(why_not_paint(*test.editor).empty());
}

TEST_CASE("layers: computed and imported weights come below the layers, those of other bones take their place") {
  PaintEditor test;
  test.play("move \"3D view/view\"\nkey Shift+Ctrl+L\nwait-idle");
  stroke(test, dab(test));
  Document document = test.editor->document();
  SkinWeights rigid(document.weights->bones(), TissueVoxels(*document.volume));
  set_weights(document, std::make_shared<const SkinWeights>(rigid));
  REQUIRE(document.layers);
  CHECK(*document.layers->base == rigid);
  CHECK(*document.weights == composed(*document.layers));
  CHECK(*document.weights != rigid);
  set_weights(document,
              std::make_shared<const SkinWeights>(std::vector<std::string>{"Other"}, TissueVoxels(*document.volume)));
  CHECK(!document.layers);
}

TEST_CASE("layers: they are in the project when it is opened again, and go on being painted") {
  PaintEditor test;
  test.play("move \"3D view/view\"\nkey Shift+Ctrl+L\nwait-idle");
  stroke(test, dab(test));
  const TemporaryFolder folder;
  DocumentWriter writer;
  create_project({.document = test.editor->document()}, folder / "a.limber", writer);
  const Document back = read_project(folder / "a.limber").document;
  CHECK(same_contents(back, test.editor->document()));
  test.editor->history->reset(back, "Open");
  choose_layer(*test.editor, 0);
  const auto mask = layers(test).layers[0]->mask;
  stroke(test, test.at(0, 30));
  CHECK(comes_out(test));
  CHECK(test.last_edit() == "Add Fore");
  CHECK(layers(test).layers[0]->mask != mask);
  test.play("key Ctrl+Z\nwait-idle");
  CHECK(same_contents(test.editor->document(), back));
}

}  // namespace limber::test
