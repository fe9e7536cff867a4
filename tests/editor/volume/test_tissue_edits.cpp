// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/tissue_edits.h"

#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::test;

TEST_CASE("tissue panel: a kind is chosen from the list, takes its usual material with it, and undo brings it back") {
  SmallEditor test({1280, 1000});
  editor::Context& c = *test.editor;
  const auto muscle = [&] { return *c.document().tissues->find(17); };
  Tissue own = muscle();
  own.young_modulus = 77;  // as if the user had set it
  editor::set_tissue(c, "Stiffness of Muscle", own);
  editor::select_tissue(c, 17, false);
  test.play(
      "wait-idle\n click \"sidebar/sections/Outliner/fold\"\n wait-idle\n click \"Tissue/Kind/list\"\n wait-idle");
  test.play("click \"Tissue/Kind/Cartilage\"\n wait-idle\n expect edit \"Set kind of Muscle\"");
  Tissue cartilage = own;
  cartilage.kind = TissueKind::Cartilage;
  apply_kind_defaults(cartilage);
  CHECK(muscle().kind == TissueKind::Cartilage);
  CHECK(muscle().young_modulus == 77);
  CHECK(muscle().poisson_ratio == cartilage.poisson_ratio);
  CHECK(muscle().priority == cartilage.priority);
  CHECK(muscle().colour == own.colour);
  test.play("key Ctrl+Z\n wait-idle");
  CHECK(muscle().kind == TissueKind::Muscle);
  CHECK(muscle().poisson_ratio == own.poisson_ratio);
  const auto edits = c.history->position();
  editor::set_kind(c, 17, TissueKind::Muscle);  // the tissue already has this kind
  CHECK(c.history->position() == edits);
}
