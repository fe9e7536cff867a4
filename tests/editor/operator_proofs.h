// SPDX-License-Identifier: AGPL-3.0-or-later
// What every operator does, shown in the real editor: an effect that is not there, what a user does with pointer and
// keys so that the operator runs, and the effect that is there then. An operator without such a proof fails a test by
// name.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "tests/editor/sitting.h"
#include "tests/editor/small_limb.h"

namespace limber::test {

// The editor as it was before the deeds.
struct Seen {
  Document document;
  int steps = 0, position = 0;
  render::Camera camera;
  std::array<render::SliceCamera, 3> slices;
  glm::dvec3 cross_hair{0};
  editor::Selection selection;
  std::string clipboard;
  std::vector<std::uint8_t> body, slice;  // small pictures of the scene, without what lies over them
};

// The limb in a sitting of its own, with a home to write into.
class Stage {
 public:
  Stage();

  editor::Editor& editor() { return sitting.editor(); }
  const Document& document() { return editor().document(); }
  void play(const std::string& script) { sitting.play(script); }
  bool is(const std::string& fact, const std::string& value = "shown") { return sitting.test.fact(fact) == value; }
  std::string fact(const std::string& name) { return sitting.test.fact(name); }
  bool ran(const std::string& id) const { return ran_.contains(id); }

  void open_limb();
  // Closes what stands in the way: menus, dialogs, messages.
  void put_away();
  void watch();  // counts the operators that run from now on
  Seen look();

  Home home;
  Sitting sitting;

 private:
  std::set<std::string> ran_;
};

enum class Shows { Nothing, InBody, InSlice };  // which picture of the scene must change

struct Proof {
  std::string id;
  std::string deeds;
  std::function<bool(Stage&, const Seen& before)> effect;  // false before the deeds, true after them
  Shows shows = Shows::Nothing;
  std::string first = "";                  // deeds that make ready
  std::function<void(Stage&)> ready = {};  // what no deed can make
};

// In the order in which one user could do them.
std::vector<Proof> proofs_of_views();
std::vector<Proof> proofs_of_navigation();
std::vector<Proof> proofs_of_tissues();
std::vector<Proof> proofs_of_work();
std::vector<Proof> proofs_of_files();
std::vector<Proof> proofs_of_pages();
std::vector<Proof> proofs_of_posing();
std::vector<Proof> proofs_of_painting();
std::vector<Proof> proofs_of_weight_edits();
std::vector<Proof> proofs_of_regions();
std::vector<Proof> proofs_of_layers();
std::vector<Proof> proofs_of_test_poses();
std::vector<Proof> proofs_of_weight_problems();
std::vector<Proof> proofs_of_joint_repair();
std::vector<Proof> proofs_of_seams();
std::vector<Proof> proofs_of_label_edits();
std::vector<Proof> proofs_of_label_brush();
std::vector<Proof> proofs_of_bone_table();
std::vector<Proof> proofs_of_images();
std::vector<Proof> proofs_of_measuring();
std::vector<Proof> proofs_of_comparing();
std::vector<Proof> proofs_of_motion();
std::vector<Proof> proofs_of_clips();
std::vector<Proof> proofs_of_curves();
std::vector<Proof> proofs_of_constraints();
std::vector<Proof> proofs_of_handling();
std::vector<Proof> proofs_of_skin();
std::vector<Proof> proofs_of_rigging();
std::vector<Proof> proofs_of_rig_fitting();

void prove(Stage& stage, const std::vector<Proof>& proofs);

}  // namespace limber::test
