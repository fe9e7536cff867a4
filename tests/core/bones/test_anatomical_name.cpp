// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/anatomical_name.h"

#include <string>

#include <doctest/doctest.h>

#include "core/tissue/tissue_table.h"

using namespace limber;

namespace {
using enum BoneRegion;

void check_one(const char* text, BoneRegion region, BodySide side, bool plural) {
  CAPTURE(text);
  const AnatomicalName name = anatomical_name(text);
  CHECK(name.regions == std::set<BoneRegion>{region});
  CHECK(name.side == side);
  CHECK(name.plural == plural);
}
}  // namespace

TEST_CASE("anatomical names: single bones of five naming schools are read with their side") {
  check_one("Left hip bone", Pelvis, BodySide::Left, false);
  check_one("hip_right", Pelvis, BodySide::Right, false);
  check_one("Hip bone (L)", Pelvis, BodySide::Left, false);
  check_one("Sacrum", Pelvis, BodySide::Middle, false);
  check_one("scapula_right", Shoulder, BodySide::Right, false);
  check_one("clavicula_left", Shoulder, BodySide::Left, false);
  check_one("rib_left_7", Thorax, BodySide::Left, false);
  check_one("Right eleventh rib", Thorax, BodySide::Right, false);
  check_one("Body of sternum", Thorax, BodySide::Middle, false);
  check_one("femur_bone", Thigh, BodySide::Middle, false);
  check_one("Left patella", Shank, BodySide::Left, false);
  check_one("Right triquetral", Hand, BodySide::Right, false);
  check_one("Navicular bone of left foot", Foot, BodySide::Left, false);
  check_one("Sesamoid bone of right foot", Foot, BodySide::Right, false);
  check_one("Left fifth metatarsal bone", Foot, BodySide::Left, false);
  check_one("Distal phalanx of left big toe", Toes, BodySide::Left, false);
  check_one("Left inferior nasal concha", Head, BodySide::Left, false);
}

TEST_CASE("anatomical names: a vertebra's letter is its level and no side") {
  check_one("vertebrae_L5", Lumbar, BodySide::Middle, false);
  check_one("vertebrae_T12", Thorax, BodySide::Middle, false);
  check_one("vertebrae_C1", Neck, BodySide::Middle, false);
  check_one("vertebrae_S1", Pelvis, BodySide::Middle, false);
  check_one("Fifth lumbar vertebra", Lumbar, BodySide::Middle, false);
  check_one("Atlas", Neck, BodySide::Middle, false);
}

TEST_CASE("anatomical names: regions of reference phantoms hold several bones or both sides") {
  check_one("Femora, upper half, medullary cavity", Thigh, BodySide::Middle, false);
  check_one("Humeri, lower half, cortical", UpperArm, BodySide::Middle, false);
  check_one("Ulnae and radii, spongiosa", Forearm, BodySide::Middle, false);
  check_one("Tibiae, fibulae and patellae, cortical", Shank, BodySide::Middle, false);
  check_one("Lower leg bones, spongiosa", Shank, BodySide::Middle, false);
  check_one("Upper arm bones, medullary cavity", UpperArm, BodySide::Middle, false);
  check_one("Ribs, cortical", Thorax, BodySide::Middle, true);
  check_one("Lumbar spine, spongiosa", Lumbar, BodySide::Middle, true);
  check_one("Pelvis, cortical", Pelvis, BodySide::Middle, false);
  const AnatomicalName feet = anatomical_name("Ankles and foot bones, cortical"),
                       hands = anatomical_name("Wrists and hand bones, spongiosa");
  CHECK(feet.regions == std::set<BoneRegion>{Foot, Toes});
  CHECK(hands.regions == std::set<BoneRegion>{Hand, Finger});
  CHECK(feet.plural);
  CHECK(hands.plural);
}

TEST_CASE("anatomical names: a bone in Latin plural is bone tissue, and a medullary cavity is marrow") {
  for (const char* text :
       {"Ulnae and radii", "Femora", "Humeri, upper half", "Tibiae, fibulae and patellae", "Scapulae"}) {
    CAPTURE(text);
    CHECK(tissue_kind_from_name(text) == TissueKind::Bone);
  }
  CHECK(tissue_kind_from_name("Femora, upper half, medullary cavity") == TissueKind::Marrow);
  CHECK(tissue_kind_from_name("Body cavity interior") == TissueKind::Cavity);
}

TEST_CASE("anatomical names: a finger's bone is read with finger and segment") {
  const auto check_finger = [](const char* text, BodyPart finger, int segment) {
    CAPTURE(text);
    const AnatomicalName name = anatomical_name(text);
    CHECK(name.regions == std::set<BoneRegion>{Finger});
    CHECK(name.finger == finger);
    CHECK(name.segment == segment);
    CHECK_FALSE(name.plural);
  };
  check_finger("Middle phalanx of left middle finger", BodyPart::Middle, 2);
  check_finger("Distal phalanx of left middle finger", BodyPart::Middle, 3);
  check_finger("Distal phalanx of right index finger", BodyPart::Index, 3);
  check_finger("Proximal phalanx of right thumb", BodyPart::Thumb, 2);
  check_finger("Left first metacarpal bone", BodyPart::Thumb, 1);
  check_finger("Left third metacarpal bone", BodyPart::Middle, 0);
}

TEST_CASE("anatomical names: what names no bone of the body says nothing") {
  for (const char* text : {"", "bone", "skeleton", "cortical bone", "label 12", "Bone marrow", "12345", "\xff\xfe"}) {
    CAPTURE(text);
    CHECK(anatomical_name(text).regions.empty());
  }
  CHECK(anatomical_name(std::string(100'000, 'l')).regions.empty());
}

TEST_CASE("anatomical names: bones of two regions in one label are told") {
  const AnatomicalName name = anatomical_name("femur and tibia left");
  CHECK(name.regions == std::set<BoneRegion>{Thigh, Shank});
  CHECK(name.side == BodySide::Left);
  CHECK(name.plural);
}
