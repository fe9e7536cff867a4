// SPDX-License-Identifier: AGPL-3.0-or-later
// Cleans a recorded walk on a real body as an animator does: filters it, plants the feet, holds a hand at a position,
// reduces it to keys, and edits its curves. The written file is measured independently of the program.
#include <doctest/doctest.h>

#include "core/base/file.h"
#include "core/rig_io/rig_io.h"
#include "editor/context/selection.h"
#include "editor/motion/graph.h"
#include "editor/motion/timeline.h"
#include "tests/editor/small_editor.h"
#include "tests/support/bvh_places.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;
using namespace limber::editor;

namespace {

constexpr const char* kBody = "data/bp3d/body_3mm_tissue.nrrd";
constexpr const char* kRig = "data/bp3d/body.armature.json";
constexpr const char* kTake = "data/bvh/cmu_12_01_walk.bvh";
constexpr int kFirstHeld = 205, kLastHeld = 235;

// A joint that stands still in some frames of the recording.
struct Stance {
  std::string joint;
  int first = 0, last = 0;
};

// Finds when the recorded feet stand, from the recording only: low and slow for a tenth of a second, without the first
// and last four frames.
std::vector<Stance> stances_of_take() {
  // Millimetres per unit of the file. A foot stands while it is slower than kSlow (mm/s) and less than kLow (mm) above
  // the ground.
  constexpr double kMm = 25.4 / 0.45, kSlow = 200, kLow = 30;
  constexpr int kLeftOut = 4, kShortest = 12;
  const BvhPlaces take(shared_path(kTake));
  std::vector<Stance> stances;
  for (const std::string side : {"Left", "Right"})
    for (const auto& [source, joint] : {std::pair{"Foot", "Foot"}, {"ToeBase", "Toes"}}) {
      const std::vector<PlacedJoint>& track = take.of(side + source);
      const int count = static_cast<int>(track.size());
      std::vector<double> heights;
      for (const PlacedJoint& placed : track) heights.push_back(placed.place.y);
      std::sort(heights.begin(), heights.end());
      const double ground = heights[heights.size() / 50];
      int since = -1;
      for (int f = 1; f < count; ++f) {
        const bool stands = f + 1 < count &&
                            distance_of(track[f + 1].place, track[f - 1].place) * kMm / (2 * take.frame_time) < kSlow &&
                            (track[f].place.y - ground) * kMm < kLow;
        if (stands && since < 0) since = f;
        if (stands || since < 0) continue;
        if (f - since >= kShortest + 2 * kLeftOut)
          stances.push_back({side + joint, since + kLeftOut, f - 1 - kLeftOut});
        since = -1;
      }
    }
  return stances;
}

double slide(const BvhPlaces& places, const Stance& stance) {
  const std::vector<PlacedJoint>& track = places.of(stance.joint);
  double most = 0;
  for (int f = stance.first; f <= stance.last; ++f)
    most = std::max(most, std::hypot(track[f].place.x - track[stance.first].place.x,
                                     track[f].place.z - track[stance.first].place.z));
  return most;
}
double largest_slide(const BvhPlaces& places, const std::vector<Stance>& stances) {
  double most = 0;
  for (const Stance& stance : stances) most = std::max(most, slide(places, stance));
  return most;
}

// Converts to the file's axes: x to the left, y up, z to the front.
std::array<double, 3> in_file(const glm::dvec3& lps) { return {lps.x, lps.z, -lps.y}; }

// Returns the position of the end of the right palm in the rig's axes.
glm::dvec3 palm(const BvhPlaces& places, const Armature& rig, int frame) {
  const auto hand =
      std::find_if(rig.bones.begin(), rig.bones.end(), [](const Bone& b) { return b.name == "RightHand"; });
  const PlainPoint tip = places.of("RightHand")[frame].carried(in_file(hand->tail - hand->head));
  return {tip.x, -tip.z, tip.y};
}

struct TakeEditor : SmallEditor {
  TakeEditor() : SmallEditor({1280, 720}, {}, false) {
    for (const char* file : {kBody, kRig, kTake})
      play("drop \"" + shared_path(file).string() + "\"\n wait-job\n wait-idle");
    play("key Ctrl+3\n wait-idle\n click \"Root motion/list\"\n click \"Root motion/Free\"\n wait-idle");
  }
  BvhPlaces exported(const char* name) {
    const std::string file = (folder / name).string();
    play("click \"File/Export/Motion...\"\n wait-idle\n key Ctrl+A\n type \"" + file +
         "\"\n key Return\n wait-job\n wait-idle");
    return BvhPlaces(file);
  }
  void typed(const std::string& field, const std::string& text) {
    play("double-click \"" + field + "/value\"\n key Ctrl+A\n type \"" + text + "\"\n key Tab\n wait-idle");
  }
  void clean() { play("click \"Motion/Clip/Clean clip...\"\n wait-idle\n key Return\n wait-job\n wait-idle"); }
  void reduce() { play("click \"Motion/Clip/Reduce to keys...\"\n wait-idle\n key Return\n wait-job\n wait-idle"); }
  void hold(const glm::dvec3& place) {
    char text[96];
    std::snprintf(text, sizeof text, "%.3f, %.3f, %.3f", place.x, place.y, place.z);
    play("click \"Motion/Clip/Hold a hand or foot...\"\n wait-idle\n click \"Hold at/Position\"\n wait-idle");
    typed("From frame", std::to_string(kFirstHeld));
    typed("To frame", std::to_string(kLastHeld));
    play(std::string("click \"Position/text\"\n key Ctrl+A\n type \"") + text +
         "\"\n wait-idle\n click Hold\n wait-job\n wait-idle");
  }
  static std::string typed_keys(const std::string& digits) {
    std::string lines;
    for (const char digit : digits) lines += std::string("\n key ") + digit;
    return lines;
  }
  // Adds degrees to one channel of all keys of a bone, in the graph editor.
  void lift_keys(const std::string& bone, const char* degrees) {
    const std::vector<Bone>& bones = editor->document().armature->bones;
    const auto found = std::find_if(bones.begin(), bones.end(), [&](const Bone& b) { return b.name == bone; });
    editor->selection->bone = static_cast<int>(found - bones.begin());
    editor->selection->bones = {*editor->selection->bone};
    if (!editor->timeline->shows_graph) play("click \"Motion/Curves/Graph editor\"\n wait-idle");
    play("move graph\n wait-idle\n key A\n key G\n key Y" + typed_keys(degrees) + "\n key Return\n wait-idle");
  }

  TemporaryFolder folder;
};

}  // namespace

TEST_CASE(
    "a real take: filtered, planted, held, made to keys and edited, its feet stand and its hand is on its place") {
  NEEDS_SHARED(kBody);
  NEEDS_SHARED(kRig);
  NEEDS_SHARED(kTake);
  const std::vector<Stance> stances = stances_of_take();
  REQUIRE(stances.size() >= 12);
  const Armature rig = read_armature(shared_path(kRig));
  TakeEditor test;
  CHECK(largest_slide(test.exported("taken.bvh"), stances) > 5);

  test.clean();
  const BvhPlaces cleaned = test.exported("cleaned.bvh");
  CHECK(largest_slide(cleaned, stances) < 0.1);

  // The target lies nearer to the body and higher than the hand.
  const glm::dvec3 place = palm(cleaned, rig, 220) + glm::dvec3(40, -60, 120);
  test.hold(place);
  const auto off_place = [&](const BvhPlaces& places) {
    double most = 0;
    for (int f = kFirstHeld; f <= kLastHeld; ++f) most = std::max(most, glm::distance(palm(places, rig, f), place));
    return most;
  };
  CHECK(off_place(cleaned) > 100);
  const BvhPlaces held = test.exported("held.bvh");
  CHECK(off_place(held) < 0.1);
  CHECK(largest_slide(held, stances) < 0.1);

  test.reduce();
  const BvhPlaces reduced = test.exported("reduced.bvh");
  CHECK(largest_slide(reduced, stances) < 2);
  CHECK(off_place(reduced) < 1.5);

  // Changing keys of the head moves nothing but the head. Changing keys of a thigh moves its foot, and planting the
  // foot again moves it back.
  test.lift_keys("Head", "12");
  const BvhPlaces nodding = test.exported("nodding.bvh");
  CHECK(distance_of(nodding.of("Head end")[300].place, reduced.of("Head end")[300].place) > 10);
  CHECK(largest_slide(nodding, stances) < 2);
  CHECK(off_place(nodding) < 1.5);
  test.lift_keys("LeftThigh", "4");
  CHECK(largest_slide(test.exported("thigh.bvh"), stances) > 2);
  test.clean();
  const BvhPlaces again = test.exported("again.bvh");
  CHECK(largest_slide(again, stances) < 2);
  CHECK(off_place(again) < 3);
}
