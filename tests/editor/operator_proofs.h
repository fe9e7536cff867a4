// SPDX-License-Identifier: AGPL-3.0-or-later
// Proofs of what every operator does, shown in the real editor. A proof has a script of pointer and keys that runs the
// operator, and an effect that must be absent before the script and present after it. A test fails and names each
// operator without a proof.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "editor/context/selection.h"
#include "render/scene/camera.h"
#include "render/scene/slice_camera.h"
#include "tests/editor/sitting.h"
#include "tests/editor/small_limb.h"

namespace limber::test {

// The state of the editor before the script.
struct Seen {
  Document document;
  int steps = 0, position = 0;
  render::Camera camera;
  std::array<render::SliceCamera, 3> slices;
  glm::dvec3 cross_hair{0};
  editor::Selection selection;
  std::string clipboard;
  std::vector<std::uint8_t> body, slice;  // small pictures of the scene, without overlays
};

// The limb in its own editor session, with a home folder to write to.
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
  // Closes open menus, dialogs and messages.
  void put_away();
  void watch();  // records the operators that run from now on
  Seen look();

  Home home;
  Sitting sitting;

 private:
  std::set<std::string> ran_;
};

enum class Shows { Nothing, InBody, InSlice };  // the picture that a proof's script must change

struct Proof {
  std::string id;
  std::string deeds;
  std::function<bool(Stage&, const Seen& before)> effect;  // false before the script, true after it
  Shows shows = Shows::Nothing;
  std::string first = "";                  // script that is played before `deeds`, to prepare the editor
  std::function<void(Stage&)> ready = {};  // preparation that no script can do, before `first`
};

// The lists of proofs, in the order in which a user could run them.
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
std::vector<Proof> proofs_of_strips();
std::vector<Proof> proofs_of_constraints();
std::vector<Proof> proofs_of_handling();
std::vector<Proof> proofs_of_skin();
std::vector<Proof> proofs_of_rigging();
std::vector<Proof> proofs_of_rig_fitting();

void prove(Stage& stage, const std::vector<Proof>& proofs);

}  // namespace limber::test
