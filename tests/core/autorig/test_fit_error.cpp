// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks the errors that automatic rigging states: on bodies whose joints are known, nine of ten joints must lie within
// their stated error.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

#include "core/autorig/auto_rig.h"
#include "core/autorig/place_in_tissue.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/rig_io/rig_templates.h"
#include "core/volume_io/volume_io.h"
#include "tests/core/autorig/fit_bodies.h"
#include "tests/support/shared_data.h"

namespace limber {

namespace {

using test::FitBody;

struct Measured {
  std::string body, joint;
  double off, stated;
};

struct Tally {
  std::vector<Measured> joints;

  void add(const FitBody& body, const AutoFit& fitted) {
    const bool tell = std::getenv("LIMBER_FIT_TABLE") != nullptr;
    std::vector<double> off;
    int within = 0;
    for (size_t b = 0; b < fitted.joints.size(); ++b) {
      const Bone& bone = fitted.armature.bones[b];
      auto same = body.truth.find(bone.name);
      if (!same) same = body.truth.find("Right" + bone.name);
      if (!same) continue;
      const Measured m{body.name, bone.name, glm::distance(bone.head, body.truth.bones[*same].head),
                       fitted.joints[b].error};
      if (tell)
        std::printf("%-34s %-22s %-13s off %6.1f stated %6.1f %s\n", m.body.c_str(), m.joint.c_str(),
                    std::string(to_string(fitted.joints[b].how)).c_str(), m.off, m.stated,
                    m.off > m.stated ? "BEYOND" : "");
      off.push_back(m.off);
      within += m.off <= m.stated;
      joints.push_back(m);
    }
    REQUIRE(!off.empty());
    std::sort(off.begin(), off.end());
    std::printf("%-34s %2d of %2d joints within what is stated, median %.1f mm, worst %.1f mm\n", body.name.c_str(),
                within, static_cast<int>(off.size()), off[off.size() / 2], off.back());
    if (tell)
      for (const std::string& text : fitted.warnings) std::printf("    %s\n", text.c_str());
  }

  static double median(std::vector<double> of) {
    std::sort(of.begin(), of.end());
    return of.empty() ? 0 : of[of.size() / 2];
  }
  double share_within() const {
    return double(std::count_if(joints.begin(), joints.end(), [](const Measured& m) { return m.off <= m.stated; })) /
           double(joints.size());
  }
  double median_off() const {
    std::vector<double> of;
    for (const Measured& m : joints) of.push_back(m.off);
    return median(of);
  }
  double median_stated() const {
    std::vector<double> of;
    for (const Measured& m : joints) of.push_back(m.stated);
    return median(of);
  }
  void print(const char* title) const {
    std::printf("%s: %zu joints, %.1f %% within what is stated; median off %.1f mm, median stated %.1f mm\n", title,
                joints.size(), 100 * share_within(), median_off(), median_stated());
  }
};

AutoFit fit_of(const FitBody& body, const Armature& rig) { return fitted_or_placed(body.volume, body.tissues, rig); }

FitBody shared_body(const char* name, const char* volume, const char* table, const char* rig) {
  VolumeFile file = read_volume(test::shared_path(volume));
  const TissueTable user = read_tissue_table(test::shared_path(table));
  return {name, std::move(file.volume), merge_tissue_tables(file.tissues, &user),
          read_armature(test::shared_path(rig))};
}

// The man of BodyParts3D with a name for every bone.
const FitBody& man() {
  static const FitBody body = shared_body("man", "data/bp3d/body_3mm_structures.nii.gz",
                                          "data/bp3d/body_structures.labels.json", "data/bp3d/body.armature.json");
  return body;
}

FitBody named(FitBody body, const std::string& name) {
  body.name = name;
  return body;
}

FitBody built(const char* name, const test::Build& build) { return named(rebuilt(man(), build), name); }

// Returns true if LIMBER_FIT_ALL is set: then each body is fitted with all four kinds of labels. Otherwise it is fitted
// with two of the four only, because a fit takes seconds.
bool fits_all() { return std::getenv("LIMBER_FIT_ALL") != nullptr; }

// Fits a body with labels of four kinds: all names; bones by region on coarse slices; one bone label; no labels.
//   turn              0: fits with the first and the last kind; 1: with the two between; both if fits_all()
//   names, one, none  out: the results with names or regions, with one bone label, without labels
void measure_labels(const FitBody& body, size_t turn, Tally& names, Tally& one, Tally& none) {
  if (const char* only = std::getenv("LIMBER_FIT_ONLY"); only && body.name != only) return;
  const Armature adult = rig_template("adult");
  if (turn == 0 || fits_all()) {
    names.add(named(body, body.name + ", bones named"), fit_of(body, adult));
    const FitBody flesh = named(without_labels(body), body.name + ", no labels");
    none.add(flesh, fit_of(flesh, adult));
  }
  if (turn == 1 || fits_all()) {
    const FitBody coarse =
        named(sampled(with_regional_labels(body), {1, 1, 3}), body.name + ", by region, 9 mm slices");
    names.add(coarse, fit_of(coarse, man().truth));
    const FitBody plain = named(with_one_bone_label(body), body.name + ", one bone label");
    one.add(plain, fit_of(plain, adult));
  }
}

}  // namespace

namespace {

void check_people(const std::vector<FitBody>& bodies) {
  Tally names, one, none;
  for (size_t i = 0; i < bodies.size(); ++i) measure_labels(bodies[i], i % 2, names, one, none);
  names.print("named bones");
  one.print("one bone label");
  none.print("no labels");
  if (fits_all()) {
    for (const Tally* tally : {&names, &one, &none}) CHECK(tally->share_within() >= 0.9);
    CHECK(names.median_off() < 6);
    CHECK(names.median_stated() < 18);
    CHECK(one.median_off() < 10.5);
    CHECK(one.median_stated() < 20);
    CHECK(none.median_off() < 10.5);
    CHECK(none.median_stated() < 27);
  }
  Tally all = names;
  for (const Tally* tally : {&one, &none})
    all.joints.insert(all.joints.end(), tally->joints.begin(), tally->joints.end());
  all.print("all");
  CHECK(all.share_within() >= 0.9);
  CHECK(all.median_off() < 8);
}

}  // namespace

TEST_CASE(
    "fit error: a man and a body of a woman's proportions lie within the error that is stated, whatever labels they "
    "have" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
  check_people({built("man", {}), built("female-like", {.wider_pelvis = 0.15, .shorter_limbs = 0.10})});
}

TEST_CASE("fit error: a child and a tall man lie within the error that is stated, whatever labels they have" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
  check_people({built("child", {.shorter_limbs = 0.14, .larger_head = 0.3, .size = 0.62}),
                built("tall", {.shorter_limbs = -0.08, .size = 1.08})});
}

TEST_CASE(
    "fit error: mirrored, and small and lying, bodies lie within the error that is stated, whatever labels they have" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
  const glm::dmat3 lying = glm::mat3_cast(glm::angleAxis(1.5708, glm::dvec3(1, 0, 0)));
  check_people({named(mirrored(man()), "mirrored"), named(moved(man(), lying, 0.9, {400, 0, -100}), "lying, small")});
}

TEST_CASE("fit error: cut bodies, limbs and hands lie within the error that is stated" * doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
  Tally tally;
  const Armature adult = rig_template("adult");
  const auto whole = [](const glm::dvec3&) { return true; };
  const std::vector<std::tuple<const char*, const char*, std::function<bool(const glm::dvec3&)>>> cuts = {
      {"legs", "adult", [](const glm::dvec3& p) { return p.z < 880 && std::abs(p.x) < 190; }},
      {"upper half", "adult", [](const glm::dvec3& p) { return p.z > 860; }},
      {"one leg", "leg", [](const glm::dvec3& p) { return p.z < 860 && p.x > 5 && p.x < 190; }},
  };
  int turn = 0;
  for (const auto& [name, rig, keep] : cuts)
    for (const FitBody& body :
         {cropped(man(), keep), with_one_bone_label(cropped(man(), keep)), without_labels(cropped(man(), keep))}) {
      if (++turn % 2 && !fits_all()) continue;
      FitBody cut = named(body, std::string(name) + (body.tissues.tissues.size() > 2 ? ", bones named"
                                                     : body.tissues.tissues.empty()  ? ", no labels"
                                                                                     : ", one bone label"));
      if (std::string(rig) == "leg")
        for (Bone& bone : cut.truth.bones)
          if (bone.name.starts_with("Left")) bone.name = bone.name.substr(4);
      tally.add(cut, fit_of(cut, rig_template(rig)));
    }
  const FitBody arm = sampled(shared_body("arm", "data/bp3d/arm_shoulder_1mm.nrrd",
                                          "data/bp3d/arm_shoulder.labels.json", "data/bp3d/arm_shoulder.armature.json"),
                              {2, 2, 2});
  const auto hand = [](const glm::dvec3& p) { return p.z < 835; };
  for (const auto& [name, rig, part] :
       {std::tuple("arm", "arm", cropped(arm, whole)), std::tuple("hand", "hand", cropped(arm, hand)),
        std::tuple("left arm", "arm", mirrored(arm))})
    for (FitBody body : {named(part, std::string(name) + ", bones named"),
                         named(with_one_bone_label(part), std::string(name) + ", one bone label"),
                         named(without_labels(part), std::string(name) + ", no labels")}) {
      if (++turn % 2 && !fits_all()) continue;
      for (Bone& bone : body.truth.bones)
        if (bone.name.starts_with("Left")) bone.name = bone.name.substr(4);
      tally.add(body, fit_of(body, rig_template(rig)));
    }
  tally.print("cut bodies");
  CHECK(tally.share_within() >= 0.9);
}

TEST_CASE("fit error: bodies whose bones are rods, and those of another make, lie within the error that is stated" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/makehuman/body_4mm.nrrd");
  const VolumeFile file = read_volume(test::shared_path("data/makehuman/body_4mm.nrrd"));
  const Armature rig = read_armature(test::shared_path("data/makehuman/body.armature.json"));
  const FitBody rods{"rods", file.volume, merge_tissue_tables(file.tissues, nullptr), rig};
  const Phantom phantom = make_body_phantom(6);
  const FitBody procedural{"procedural body", phantom.volume, phantom.tissues, phantom.armature};
  // This phantom stands with its arms held away from the trunk.
  const test::StandingLandmarks at{
      .hip = 915, .shoulder = 1430, .neck = 1500, .arm_from = 215, .arm_to = 330, .widest = 210, .head = {0, 10, 1600}};
  Tally tally;
  tally.add(rods, fit_of(rods, rig));
  tally.add(named(without_labels(rods), "rods, no labels"), fit_of(without_labels(rods), rig));
  tally.add(procedural, fit_of(procedural, rig_template("adult")));
  const FitBody female =
      named(rebuilt(procedural, {.wider_pelvis = 0.15, .shorter_limbs = 0.1}, at), "procedural female");
  tally.add(female, fit_of(female, rig_template("adult")));
  const FitBody flesh = named(without_labels(female), "procedural female, no labels");
  tally.add(flesh, fit_of(flesh, rig_template("adult")));
  tally.print("other bodies");
  CHECK(tally.share_within() >= 0.9);
}

namespace {

// How a dog differs from the template: `stretch` scales all of it along x, y and z, the others scale single parts.
struct AnimalBuild {
  glm::dvec3 stretch{1};
  double longer_legs = 1, longer_neck = 1, longer_tail = 1, fatter = 1;
  double turn = 0;  // turns the animal about the vertical, radians
};

FitBody four_legged(const char* name, const AnimalBuild& build) {
  const Armature rig = rig_template("quadruped");
  Armature other = rig;
  std::vector<double> radii;
  const auto is = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  for (size_t b = 0; b < rig.bones.size(); ++b) {
    Bone& bone = other.bones[b];
    const std::string& part = bone.name;
    const bool leg = is(part, "leg") || is(part, "paw") || is(part, "toes");
    const double longer = leg                ? build.longer_legs
                          : is(part, "Neck") ? build.longer_neck
                          : is(part, "Tail") ? build.longer_tail
                                             : 1;
    const Bone& before = rig.bones[b];
    bone.head = before.parent < 0 ? before.head
                                  : other.bones[before.parent].head +
                                        (rig.bones[before.parent].tail == before.head
                                             ? other.bones[before.parent].tail - other.bones[before.parent].head
                                             : build.stretch * (before.head - rig.bones[before.parent].head));
    bone.tail = bone.head + longer * build.stretch * (before.tail - before.head);
    radii.push_back(build.fatter * (is(part, "Thorax") || is(part, "Lumbar") ? 125
                                    : is(part, "Pelvis")                     ? 105
                                    : is(part, "UpperHind")                  ? 60
                                    : is(part, "Scapula")                    ? 50
                                    : is(part, "Neck")                       ? 70
                                    : is(part, "Head")                       ? 60
                                    : is(part, "Jaw")                        ? 30
                                    : is(part, "Tail")                       ? 22
                                    : is(part, "UpperFore")                  ? 42
                                    : is(part, "LowerHind")                  ? 34
                                                                             : 26));
  }
  const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(build.turn, glm::dvec3(0, 0, 1)));
  for (Bone& bone : other.bones) bone.head = turn * bone.head, bone.tail = turn * bone.tail;
  return test::animal(name, other, radii, 7);
}

}  // namespace

TEST_CASE("fit error: animals lie within the error that is stated" * doctest::test_suite("slow")) {
  Tally tally;
  const FitBody dachshund = four_legged(
      "long low animal",
      {.stretch = {1, 1.25, 1}, .longer_legs = 0.75, .longer_neck = 0.9, .longer_tail = 0.8, .fatter = 0.85});
  const FitBody horse = four_legged("tall animal", {.stretch = {1.6, 1.7, 1.9},
                                                    .longer_legs = 1.3,
                                                    .longer_neck = 1.5,
                                                    .longer_tail = 0.7,
                                                    .fatter = 1.5,
                                                    .turn = 1.3});
  for (const FitBody& body : {dachshund, horse}) {
    tally.add(body, fit_of(body, rig_template("quadruped")));
    const FitBody flesh = named(without_labels(body), body.name + ", no labels");
    tally.add(flesh, fit_of(flesh, rig_template("quadruped")));
  }
  tally.print("animals");
  CHECK(tally.share_within() >= 0.9);
  CHECK(tally.median_off() < 60);
}

TEST_CASE("fit error: a rig of another kind of body than the tissue's is said to fit little, and claims nothing" *
          doctest::test_suite("slow")) {
  const FitBody animal = four_legged("animal", {});
  const AutoFit fitted = fit_of(animal, rig_template("adult"));
  CHECK(std::any_of(fitted.warnings.begin(), fitted.warnings.end(), [](const std::string& text) {
    return text.find("differs much from the body") != std::string::npos;
  }));
  if (std::getenv("LIMBER_FIT_TABLE"))
    std::printf("misfit %.4f of the diagonal\n",
                fitted.misfit_mm / glm::length(glm::dvec3(animal.volume.grid.size) * animal.volume.grid.spacing));
  for (const std::string& text : fitted.warnings) CAPTURE(text);
  std::vector<double> stated;
  for (const JointFit& joint : fitted.joints) stated.push_back(joint.error);
  CHECK(*std::min_element(stated.begin(), stated.end()) > 30);
  CHECK(Tally::median(stated) > 100);
}

TEST_CASE("fit error: a rig that is merely scaled to the tissue says how far it may be off" *
          doctest::test_suite("slow")) {
  Armature snake;
  for (int b = 0; b < 4; ++b)
    snake.bones.push_back(
        {.name = "S" + std::to_string(b), .parent = b - 1, .head = {0, 0, 10.0 * b}, .tail = {0, 0, 10.0 * (b + 1)}});
  const FitBody animal = four_legged("animal", {});
  const AutoFit fitted = fit_of(animal, snake);
  for (const JointFit& joint : fitted.joints) CHECK(joint.error > 200);
  CHECK(std::any_of(fitted.warnings.begin(), fitted.warnings.end(),
                    [](const std::string& text) { return text.find("scaled to the tissue") != std::string::npos; }));
}

}  // namespace limber
