// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/tissue_table.h"

#include <filesystem>

#include <doctest/doctest.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/volume_io/tissue_table_io.h"
#include "tests/support/shared_data.h"

using namespace limber;
namespace fs = std::filesystem;

namespace {
TissueTable present(std::initializer_list<int> labels) {
  TissueTable table;
  for (int label : labels) {
    Tissue tissue;
    tissue.label = static_cast<Label>(label);
    tissue.file_value = label;
    table.tissues.push_back(tissue);
  }
  return table;
}
}  // namespace

TEST_CASE("tissue table: kinds follow from anatomical names") {
  const std::pair<const char*, TissueKind> names[] = {
      {"Left femur", TissueKind::Bone},
      {"vertebrae_C1", TissueKind::Bone},
      {"rib_left_12", TissueKind::Bone},
      {"BoneMarrow", TissueKind::Marrow},
      {"Bone_cortical", TissueKind::CorticalBone},
      {"Skull_cancellous", TissueKind::CancellousBone},
      {"vastus_lateralis_muscle", TissueKind::Muscle},
      {"Humeral head of right flexor carpi ulnaris", TissueKind::Muscle},
      {"patellar_ligament", TissueKind::Tendon},
      {"adductor_magnus_tendon", TissueKind::Tendon},
      {"patellar_cartilage", TissueKind::Cartilage},
      {"medial_meniscus", TissueKind::Cartilage},
      {"Intervertebral disk of axis", TissueKind::Cartilage},
      {"infrapatellar_fat_body", TissueKind::Fat},
      {"popliteal_artery", TissueKind::Vessel},
      {"peroneus_nerve", TissueKind::Nerve},
      {"spinal_cord", TissueKind::Nerve},
      {"lung_upper_lobe_left", TissueKind::Organ},
      {"liver", TissueKind::Organ},
      {"brain", TissueKind::Brain},
      {"skin (synth)", TissueKind::Skin},
      {"body cavity (synth)", TissueKind::Cavity},
      {"Segment_7", TissueKind::Unknown},
  };
  for (const auto& [name, kind] : names) {
    CAPTURE(name);
    CHECK(to_string(tissue_kind_from_name(name)) == to_string(kind));
  }
}

TEST_CASE("tissue table: every kind has a name that is read back as that kind") {
  for (int i = 1; i <= static_cast<int>(TissueKind::Nail); ++i) {
    const auto kind = static_cast<TissueKind>(i);
    CHECK(tissue_kind_from_text(to_string(kind)) == kind);
  }
}

TEST_CASE(
    "tissue table: every kind says where its material comes from, and what is said of flesh is not said of bone") {
  for (int k = 0; k <= int(TissueKind::Nail); ++k) {
    Tissue tissue;
    tissue.kind = TissueKind(k);
    apply_kind_defaults(tissue);
    const MaterialSources sources = material_sources(tissue.kind);
    CAPTURE(to_string(tissue.kind));
    CHECK(!sources.density.empty());
    CHECK((sources.stiffness.find("rigid") != std::string_view::npos) == is_bone(tissue.kind));
    CHECK((sources.poisson.find("water") != std::string_view::npos) == (tissue.poisson_ratio > 0.49));
  }
}

TEST_CASE("tissue table: JSON, Slicer and ITK-SNAP tables say the same") {
  const TissueTable json = parse_tissue_table(
      R"({"17": {"name": "vastus", "kind": "muscle", "colour": "#ff0000", "density": 1.2}, "5": "fat", "0": "air"})",
      "t.json");
  const TissueTable slicer =
      parse_tissue_table("# Color table\n0 air 0 0 0 0\n5 fat 10 20 30 255\r\n17 vastus 255 0 0 255\n", "t.ctbl");
  const TissueTable snap = parse_tissue_table(
      "# labels\n0 0 0 0 0 0 0 \"Clear Label\"\n17 255 0 0 1 1 1 \"vastus\"\n5 10 20 30 1 1 1 \"fat\"\n", "t.txt");
  for (const TissueTable* table : {&json, &slicer, &snap}) {
    REQUIRE(table->tissues.size() == 2);
    CHECK(table->find(17)->name == "vastus");
    CHECK(table->find(17)->kind == TissueKind::Muscle);
    CHECK(table->find(17)->colour == glm::vec3(1, 0, 0));
    CHECK(table->find(5)->kind == TissueKind::Fat);
    CHECK(table->find(6) == nullptr);
  }
  CHECK(json.find(17)->density == 1.2);
  CHECK(json.source == "t.json");
}

TEST_CASE("tissue table: what is written is read back, in all three formats") {
  const Path folder = fs::temp_directory_path() / ("limber-tissues-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const TissueTable table = parse_tissue_table(
      R"({"-3": "left_femur", "17": {"name": "vastus", "kind": "muscle", "colour": [51, 102, 153]},
        "4000000000": "skin"})",
      "t.json");
  for (const char* name : {"a.json", "a.ctbl", "a.txt"}) {
    CAPTURE(name);
    write_tissue_table(table, folder / name);
    CHECK(is_tissue_table(folder / name));
    const TissueTable back = read_tissue_table(folder / name);
    REQUIRE(back.tissues.size() == 3);
    for (const Tissue& tissue : table.tissues) {
      const Tissue* same = back.find_file_value(tissue.file_value);
      REQUIRE(same != nullptr);
      CHECK(same->name == tissue.name);
      CHECK(same->kind == tissue.kind);
      CHECK(glm::length(same->colour - tissue.colour) < 0.003f);
    }
  }
  CHECK_THROWS_AS(write_tissue_table(table, folder / "a.png"), Error);
  fs::remove_all(folder);
}

TEST_CASE("tissue table: wrong tables are refused with the line or key that is wrong") {
  for (const char* text :
       {"", "[1, 2]", "{\"a\": \"b\"}", "{\"1\": 5}", "{\"1\": {\"kind\": \"wood\"}}", "{\"1\": {\"density\": -1}}",
        "{\"1\": {\"name\"", "5 fat", "5 fat a b c 255", "x fat 0 0 0 255", "5 0 0 0 1 \"fat\"", "1.5 fat 0 0 0 255",
        "{\"1\": {\"colour\": \"red\"}}", "# nothing\n"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse_tissue_table(text, "t"), Error);
  }
}

TEST_CASE(
    "tissue table: the user's entries win, then the file's names, then a built-in table that covers every label") {
  const TissueTable arm = merge_tissue_tables(present({5, 17, 111, 143}), nullptr);
  CHECK(arm.source == "built-in table of Bender's arm");
  CHECK(arm.find(143)->kind == TissueKind::Skin);
  CHECK(merge_tissue_tables(present({5, 17, 111, 143, 144}), nullptr).find(143)->kind == TissueKind::Unknown);
  CHECK(merge_tissue_tables(present({1, 2, 3, 4, 5, 6, 7, 8}), nullptr).source.empty());
  CHECK(merge_tissue_tables(present({1, 27, 79, 86, 87}), nullptr).find(27)->name == "vertebrae_L5");

  TissueTable in_file = present({5, 17});
  in_file.tissues[0].name = "rind";
  in_file.tissues[1].name = "humerus";
  const TissueTable user = parse_tissue_table(R"({"5": {"name": "skin"}})", "mine.json");
  const TissueTable merged = merge_tissue_tables(in_file, &user);
  CHECK(merged.find(5)->name == "skin");
  CHECK(merged.find(17)->name == "humerus");
  CHECK(merged.source == "mine.json");
}

TEST_CASE("tissue table: named bones become the only bones, and unknown ones are refused") {
  const TissueTable arm = merge_tissue_tables(present({5, 17, 111, 143, 209}), nullptr);
  const TissueTable changed = with_bones(arm, {111, 5});
  CHECK(is_bone(changed.find(111)->kind));
  CHECK(is_bone(changed.find(5)->kind));
  CHECK_FALSE(is_bone(changed.find(209)->kind));
  CHECK_THROWS_AS(with_bones(arm, {112}), Error);
}

TEST_CASE("tissue table: words find the class of nearly every BodyParts3D structure") {
  NEEDS_SHARED("data/bp3d/body_structures.labels.json");
  const TissueTable table = read_tissue_table(test::shared_path("data/bp3d/body_structures.labels.json"));
  int same = 0;
  for (const Tissue& tissue : table.tissues) {
    const bool agrees = tissue_kind_from_name(tissue.name) == tissue.kind;
    INFO(tissue.name, " is ", to_string(tissue.kind), ", words say ", to_string(tissue_kind_from_name(tissue.name)));
    same += agrees;
  }
  CHECK(table.tissues.size() == 519);
  CHECK(same >= 500);
}

TEST_CASE("tissue table: labels of unknown kind each get a colour of their own, the same every time") {
  std::vector<glm::vec3> colours;
  for (int value = 1; value <= 60; ++value) {
    Tissue tissue;
    tissue.file_value = value;
    apply_kind_defaults(tissue);
    Tissue again = tissue;
    apply_kind_defaults(again);
    CHECK(again.colour == tissue.colour);
    for (const glm::vec3& other : colours) CHECK(glm::distance(other, tissue.colour) > 0.01f);
    colours.push_back(tissue.colour);
  }
}

TEST_CASE("tissue table: organs have the colours of anatomy atlases in any vocabulary, both sides the same") {
  const auto colour = [](const char* name, TissueKind kind, Label label = 5) {
    Tissue tissue;
    tissue.label = label;
    tissue.file_value = label;
    tissue.name = name;
    tissue.kind = kind;
    apply_kind_defaults(tissue);
    return tissue.colour;
  };
  const auto organ = [&](const char* name, Label label = 5) { return colour(name, TissueKind::Organ, label); };
  CHECK(organ("kidney_left") == organ("Right kidney", 9));
  CHECK(organ("liver") != organ("spleen"));
  const glm::vec3 bile = organ("gallbladder"), vein = colour("inferior_vena_cava", TissueKind::Vessel),
                  artery = colour("aorta", TissueKind::Vessel);
  CHECK((bile.g > bile.r && bile.g > bile.b));
  CHECK((vein.b > vein.r && artery.r > artery.b));
  // An organ that is not known gets a colour by its label. All muscles have the colour of their kind.
  CHECK(organ("thing", 5) != organ("thing", 6));
  CHECK(colour("Left brachialis", TissueKind::Muscle) == colour("Right soleus", TissueKind::Muscle));
}
