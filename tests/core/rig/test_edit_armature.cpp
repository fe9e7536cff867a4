// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/rig/edit_armature.h"
#include "core/rig/mirror.h"

using namespace limber;

namespace {

// A trunk with two arms of two bones each, as a body faces the viewer.
Armature small_rig() {
  Armature rig;
  rig.bones.push_back({"Trunk", -1, {0, 0, 0}, {0, 0, 100}});
  rig.bones.push_back({"Arm.L", 0, {0, 0, 100}, {60, 0, 90}});
  rig.bones.push_back({"Fore.L", 1, {60, 0, 90}, {120, -10, 80}});
  rig.bones.push_back({"Arm.R", 0, {0, 0, 100}, {-60, 0, 90}});
  rig.bones.push_back({"Fore.R", 3, {-60, 0, 90}, {-120, -10, 80}});
  for (const int hinge : {2, 4}) {
    rig.bones[hinge].limits.type = JointLimits::Type::Hinge;
    rig.bones[hinge].limits.axis = {0, 0, hinge == 2 ? 1.0 : -1.0};
    rig.bones[hinge].limits.maximum = 2;
  }
  return rig;
}

const Bone& named(const Armature& rig, const std::string& name) { return rig.bones[require_bone(rig, name)]; }

std::string parent_of(const Armature& rig, const std::string& name) {
  const int parent = named(rig, name).parent;
  return parent < 0 ? "" : rig.bones[parent].name;
}

}  // namespace

TEST_CASE("edited rigs: ends that meet are one joint and move together") {
  const Armature rig = small_rig();
  CHECK(joint_of(rig, {1, true}).size() == 2);
  CHECK(joint_of(rig, {3, false}).size() == 3);
  CHECK(joint_of(rig, {0, false}).size() == 1);
  const Armature next = with_moved_ends(rig, {{2, false}}, [](const glm::dvec3& p) { return p + glm::dvec3(0, 7, 0); });
  CHECK(next.bones[1].tail == glm::dvec3(60, 7, 90));
  CHECK(next.bones[2].head == glm::dvec3(60, 7, 90));
  CHECK(next.bones[3] == rig.bones[3]);
  CHECK(next.bones[4] == rig.bones[4]);
}

TEST_CASE("edited rigs: a turned bone takes its axes and its hinge along") {
  const Armature rig = small_rig();
  const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  const glm::dvec3 head = rig.bones[2].head;
  const Armature next =
      with_moved_ends(rig, {{2, true}}, [&](const glm::dvec3& p) { return head + turn * (p - head); });
  const glm::dvec3 along = glm::normalize(next.bones[2].tail - head);
  CHECK(std::abs(glm::dot(next.bones[2].limits.axis, along) -
                 glm::dot(rig.bones[2].limits.axis, glm::normalize(rig.bones[2].tail - head))) < 1e-12);
  // A translation does not turn the axes.
  const Armature shifted =
      with_moved_ends(rig, {{2, false}, {2, true}}, [](const glm::dvec3& p) { return p + glm::dvec3(1, 2, 3); });
  CHECK(shifted.bones[2].limits == rig.bones[2].limits);
  CHECK(glm::distance(rest_axes(shifted.bones[2])[0], rest_axes(rig.bones[2])[0]) < 1e-12);
}

TEST_CASE("edited rigs: bones are added, extruded from either end and named apart") {
  const Armature rig = small_rig();
  const Armature tip = extruded(rig, {2, true}, {150, -10, 80});
  CHECK(tip.bones.back().name == "Fore.L.001");
  CHECK(parent_of(tip, "Fore.L.001") == "Fore.L");
  CHECK(is_connected(tip, 5));
  const Armature beside = extruded(tip, {2, false}, {60, 0, 50});
  CHECK(beside.bones.back().name == "Fore.L.002");
  CHECK(parent_of(beside, "Fore.L.002") == "Arm.L");
  CHECK(with_bone(rig, "Tail", -1, {0, 0, 0}, {0, 9, 0}).bones.back().parent == -1);
  CHECK(free_name(rig, "Neck") == "Neck");
}

TEST_CASE("edited rigs: a gap is filled by a bone that hangs on the first and carries the second") {
  Armature rig = small_rig();
  rig.bones.push_back({"Hand", -1, {140, 0, 70}, {160, 0, 70}});
  const Armature chain = filled(rig, {2, true}, {5, false});
  CHECK(parent_of(chain, "Fore.L.001") == "Fore.L");
  CHECK(parent_of(chain, "Hand") == "Fore.L.001");
  CHECK(is_connected(chain, require_bone(chain, "Hand")));
  CHECK(is_connected(chain, require_bone(chain, "Fore.L.001")));
  // A bone from tail to tail within one tree gets no children. A bone that starts at a head gets that bone's parent.
  const Armature across = filled(rig, {2, true}, {4, true});
  CHECK(across.bones.back().tail == rig.bones[4].tail);
  CHECK(parent_of(across, "Fore.R") == "Arm.R");
  CHECK(parent_of(filled(rig, {5, false}, {2, true}), "Hand.001").empty());
  // A root does not become the child of its own child.
  CHECK(parent_of(filled(rig, {2, true}, {0, false}), "Trunk").empty());
  CHECK_THROWS_AS(filled(rig, {1, true}, {2, false}), Error);
}

TEST_CASE("edited rigs: children of a removed bone hang on the next one that stays") {
  const Armature rig = small_rig();
  const Armature next = without_bones(rig, {1});
  CHECK(next.bones.size() == 4);
  CHECK(parent_of(next, "Fore.L") == "Trunk");
  CHECK(named(next, "Fore.L").head == named(rig, "Fore.L").head);
  CHECK(parent_of(without_bones(rig, {0, 1}), "Fore.L").empty());
  CHECK_THROWS_AS(without_bones(rig, {0, 1, 2, 3, 4}), Error);
}

TEST_CASE("edited rigs: a dissolved bone leaves the chain whole") {
  const Armature rig = small_rig();
  const Armature next = dissolved(rig, {2});
  CHECK(next.bones.size() == 4);
  CHECK(named(next, "Arm.L").tail == named(rig, "Fore.L").tail);
  // The trunk's tail stays, since the other arm is attached to it.
  const Armature shoulder = dissolved(rig, {1});
  CHECK(named(shoulder, "Trunk").tail == named(rig, "Trunk").tail);
  CHECK(parent_of(shoulder, "Fore.L") == "Trunk");
  // When several bones are dissolved, the tail of the last one remains.
  const Armature longer = extruded(rig, {2, true}, {150, -10, 80});
  CHECK(named(dissolved(longer, {2, 5}), "Arm.L").tail == glm::dvec3(150, -10, 80));
}

TEST_CASE("edited rigs: halves follow one another, and children the second") {
  const Armature next = subdivided(small_rig(), {1});
  CHECK(next.bones.size() == 6);
  CHECK(parent_of(next, "Arm.L.001") == "Arm.L");
  CHECK(parent_of(next, "Fore.L") == "Arm.L.001");
  CHECK(named(next, "Arm.L").tail == glm::dvec3(30, 0, 95));
  CHECK(named(next, "Arm.L.001").tail == glm::dvec3(60, 0, 90));
  CHECK_NOTHROW(check_armature(next, "test"));
}

TEST_CASE("edited rigs: copies hang together as what they are copies of") {
  const Armature next = duplicated(small_rig(), {2, 1});
  CHECK(next.bones.size() == 7);
  CHECK(parent_of(next, "Arm.L.001") == "Trunk");
  CHECK(parent_of(next, "Fore.L.001") == "Arm.L.001");
}

TEST_CASE("edited rigs: a new name is made free, an empty one refused") {
  const Armature rig = small_rig();
  CHECK(renamed(rig, 2, "Forearm").bones[2].name == "Forearm");
  CHECK(renamed(rig, 2, "Fore.L").bones[2].name == "Fore.L");
  CHECK(renamed(rig, 2, "Arm.R").bones[2].name == "Arm.R.001");
  CHECK_THROWS_AS(renamed(rig, 2, ""), Error);
}

TEST_CASE("edited rigs: a bone hangs on another one, connected or where it is") {
  const Armature rig = small_rig();
  const Armature kept = parented(rig, {1}, 4, Join::KeepOffset);
  CHECK(parent_of(kept, "Arm.L") == "Fore.R");
  CHECK(named(kept, "Arm.L").head == named(rig, "Arm.L").head);
  CHECK_NOTHROW(check_armature(kept, "test"));
  const Armature connected = parented(rig, {1}, 4, Join::Connected);
  CHECK(named(connected, "Arm.L").head == named(rig, "Fore.R").tail);
  CHECK(named(connected, "Fore.L").head == named(connected, "Arm.L").tail);
  CHECK(is_connected(connected, require_bone(connected, "Arm.L")));
  CHECK_THROWS_AS(parented(rig, {1}, 2, Join::KeepOffset), Error);
  CHECK(parent_of(unparented(rig, {2}), "Fore.L").empty());
  const Armature loose = separated(rig, {1});
  CHECK(parent_of(loose, "Arm.L").empty());
  CHECK(parent_of(loose, "Fore.L").empty());
  CHECK(parent_of(separated(rig, {1, 2}), "Fore.L") == "Arm.L");
}

TEST_CASE("edited rigs: a flipped chain runs the other way, twice as before") {
  const Armature rig = small_rig();
  const Armature next = with_flipped_direction(rig, {1, 2});
  CHECK(parent_of(next, "Arm.L") == "Fore.L");
  CHECK(parent_of(next, "Fore.L").empty());
  CHECK(named(next, "Fore.L").head == named(rig, "Fore.L").tail);
  CHECK(is_connected(next, require_bone(next, "Arm.L")));
  const Armature again = with_flipped_direction(next, {require_bone(next, "Arm.L"), require_bone(next, "Fore.L")});
  CHECK(named(again, "Arm.L").head == named(rig, "Arm.L").head);
  CHECK(std::abs(std::remainder(named(again, "Fore.L").roll - named(rig, "Fore.L").roll, 2 * std::acos(-1.0))) < 1e-9);
  CHECK_NOTHROW(check_armature(next, "test"));
}

TEST_CASE("edited rigs: bones roll about themselves, by an angle or towards a direction") {
  const Armature rig = small_rig();
  const glm::dmat3 before = rest_axes(rig.bones[1]), after = rest_axes(rolled(rig, {1}, 0.5).bones[1]);
  CHECK(glm::distance(after[1], before[1]) < 1e-12);
  CHECK(glm::distance(after[0], glm::angleAxis(0.5, before[1]) * before[0]) < 1e-12);
  const glm::dvec3 z = rest_axes(with_z_towards(rig, {1}, {0, -1, 0}).bones[1])[2];
  CHECK(glm::dot(z, glm::dvec3(0, -1, 0)) > 0.99);
}

TEST_CASE("edited rigs: what is done on one side happens on the other in the mirror") {
  const Armature rig = small_rig();
  const Armature after = with_moved_ends(rig, {{2, true}}, [](const glm::dvec3& p) { return p + glm::dvec3(5, 6, 7); });
  const Armature both = with_mirrored_changes(rig, after);
  CHECK(glm::distance(named(both, "Fore.R").tail, named(both, "Fore.L").tail * glm::dvec3(-1, 1, 1)) < 1e-9);
  CHECK(named(both, "Arm.R") == named(rig, "Arm.R"));
  // Bones that were moved on both sides keep both changes.
  const Armature own =
      with_moved_ends(rig, {{2, true}, {4, true}}, [](const glm::dvec3& p) { return p + glm::dvec3(5, 6, 7); });
  CHECK(with_mirrored_changes(rig, own) == own);

  // A bone that is added on one side is added on the other.
  const Armature grown = with_mirrored_changes(rig, extruded(rig, {2, true}, {130, -10, 80}));
  CHECK(parent_of(grown, "Fore.R.001") == "Fore.R");
  CHECK(glm::distance(named(grown, "Fore.R.001").tail, {-130, -10, 80}) < 1e-9);

  const Armature swapped = mirrored_bones(rig, {1, 2, 3, 4});
  CHECK(glm::distance(named(swapped, "Arm.L").tail, named(rig, "Arm.L").tail) < 1e-9);
  CHECK(swapped.bones[1].name == "Arm.R");
  CHECK(swapped.bones[1].tail.x < 0);
}

TEST_CASE("edited rigs: poses follow their bones by name") {
  const Armature rig = small_rig();
  Pose pose = rest_pose(rig);
  pose.rotation[2] = glm::angleAxis(0.5, glm::dvec3(1, 0, 0));
  pose.root_translation = {1, 2, 3};
  const Armature next = without_bones(rig, {1});
  const Pose followed = carried(pose, bones_of(rig, next));
  CHECK(followed.rotation[require_bone(next, "Fore.L")] == pose.rotation[2]);
  CHECK(followed.root_translation == pose.root_translation);
  CHECK(carried(pose, bones_of(rig, extruded(rig, {2, true}, {0, 0, 0}))).rotation.back() == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("edited rigs: a thousand edits by chance leave a rig that is one") {
  std::mt19937 random(7);
  const auto pick = [&](int count) { return std::uniform_int_distribution<int>(0, count - 1)(random); };
  Armature rig = small_rig();
  for (int i = 0; i < 1000; ++i) {
    const int count = static_cast<int>(rig.bones.size());
    const std::vector<int> some = {pick(count), pick(count)};
    const glm::dvec3 place(pick(200) - 100, pick(200) - 100, pick(200) - 100);
    try {
      switch (count > 40 ? 2 + pick(2) : pick(11)) {
        case 0: rig = extruded(rig, {some[0], pick(2) == 0}, place); break;
        case 1: rig = subdivided(rig, some); break;
        case 2: rig = without_bones(rig, some); break;
        case 3: rig = dissolved(rig, some); break;
        case 4: rig = duplicated(rig, {some[0]}); break;
        case 5: rig = parented(rig, {some[0]}, some[1], pick(2) ? Join::Connected : Join::KeepOffset); break;
        case 6: rig = separated(rig, {some[0]}); break;
        case 7: rig = with_flipped_direction(rig, some); break;
        case 8: rig = mirrored_bones(rig, some); break;
        case 9: rig = renamed(rig, some[0], rig.bones[some[1]].name); break;
        case 10: rig = with_moved_ends(rig, {{some[0], true}}, [&](const glm::dvec3&) { return place; }); break;
      }
    } catch (const Error&) {
      // The edit was refused, so the rig is unchanged.
    }
    REQUIRE_NOTHROW(check_armature(rig, "test"));
  }
}

TEST_CASE("edited rigs: many names change at once, sides swap, and no two bones get one name") {
  Armature rig;
  rig.bones = {{"Spine", -1, {0, 0, 0}, {0, 0, 9}, 0, {}},
               {"Arm.L", 0, {1, 0, 9}, {9, 0, 9}, 0, {}},
               {"Arm.R", 0, {-1, 0, 9}, {-9, 0, 9}, 0, {}}};
  const Armature swapped = with_names_changed(rig, {0, 1, 2}, {.other_side = true});
  CHECK(swapped.bones[0].name == "Spine");
  CHECK(swapped.bones[1].name == "Arm.R");
  CHECK(swapped.bones[2].name == "Arm.L");
  CHECK(with_names_changed(rig, {1}, {.find = "A", .replace = "AA", .prefix = "x ", .suffix = "!"}).bones[1].name ==
        "x AArm.L!");
  CHECK_THROWS_AS(with_names_changed(rig, {1}, {.other_side = true}), Error);
  CHECK_THROWS_AS(with_names_changed(rig, {0}, {.find = "Spine"}), Error);
}
