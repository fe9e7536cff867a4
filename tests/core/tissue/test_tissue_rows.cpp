// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the table of tissues: names of the common label tables, densities as in their sources, and mixtures.
#include "core/tissue/tissue_rows.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/tissue/composition.h"
#include "core/tissue/dielectric.h"
#include "tests/support/shared_data.h"
#include "tests/support/tissue_names_in_use.h"

using namespace limber;
using namespace limber::test;

namespace {

Tissue tissue_named(const std::string& name) {
  Tissue tissue;
  tissue.name = name;
  tissue.kind = tissue_kind_from_name(name);
  apply_kind_defaults(tissue);
  return tissue;
}

// Returns the name of the matched row, "muscle (kind)" if only the kind matched, or "none".
std::string row_of(const std::string& name) {
  const TissueMatch match = tissue_rows().match(tissue_named(name));
  return match.row < 0 ? "none" : tissue_rows().rows[match.row].names.name + (match.by_name ? "" : " (kind)");
}

// Checks that every tissue has a permittivity, a density with its source, and its elements.
void check_known(const std::vector<Tissue>& tissues) {
  TissueTable table;
  table.tissues = tissues;
  for (std::size_t i = 0; i < tissues.size(); ++i) table.tissues[i].label = static_cast<Label>(i + 1);
  const TissueMaterials found = tissue_materials(table, read_dielectric_table(), 900e6);
  CHECK_MESSAGE(found.unmatched.empty(),
                doctest::String(found.unmatched.empty() ? "" : found.unmatched.front().c_str()));
  for (const TissueMaterial& material : found.materials) {
    CHECK_MESSAGE(material.density_source.size() > 10, material.name);
    CHECK_MESSAGE(material.found.find(": ") != std::string::npos, material.name);
  }
  CHECK(media_of(table, read_composition_table(), "test").size() == tissues.size());
}

// Checks that each name matches the expected row, and that all data for a simulation are known.
void check_names(const std::vector<NamesOfRow>& expected) {
  std::vector<Tissue> tissues;
  for (const auto& [row, names] : expected)
    for (const std::string& name : names) {
      CHECK_MESSAGE(row_of(name) == row, name);
      tissues.push_back(tissue_named(name));
    }
  check_known(tissues);
}

}  // namespace

TEST_CASE("tissue rows: every class of TotalSegmentator is the tissue that it holds, arteries and veins alike") {
  TissueTable present;
  for (int value = 1; value <= 117; ++value) {
    Tissue tissue;
    tissue.label = static_cast<Label>(value);
    tissue.file_value = value;
    present.tissues.push_back(tissue);
  }
  const TissueTable total = merge_tissue_tables(present, nullptr);
  REQUIRE(total.source == "built-in table of TotalSegmentator 2");
  check_known(total.tissues);
  const auto row = [&](int label) {
    return tissue_rows().rows[tissue_rows().match(*total.find(static_cast<Label>(label))).row].names.name;
  };
  const std::vector<const char*> first = {"spleen",
                                          "kidney",
                                          "kidney",
                                          "gall bladder",
                                          "liver",
                                          "stomach",
                                          "pancreas",
                                          "adrenal gland",
                                          "adrenal gland",
                                          "lung",
                                          "lung",
                                          "lung",
                                          "lung",
                                          "lung",
                                          "oesophagus",
                                          "trachea",
                                          "thyroid",
                                          "small intestine",
                                          "duodenum",
                                          "colon",
                                          "urinary bladder",
                                          "prostate",
                                          "cyst or effusion",
                                          "cyst or effusion",
                                          "sacrum",
                                          "sacrum"};
  for (std::size_t i = 0; i < first.size(); ++i) CHECK_MESSAGE(row(static_cast<int>(i) + 1) == first[i], (i + 1));
  for (int label = 27; label <= 43; ++label) CHECK_MESSAGE(row(label) == "vertebra", label);
  for (int label = 44; label <= 50; ++label) CHECK_MESSAGE(row(label) == "cervical vertebra", label);
  CHECK(row(51) == "heart");
  for (int label = 52; label <= 68; ++label) CHECK_MESSAGE(row(label) == "blood", label);
  for (int label = 69; label <= 70; ++label) CHECK(row(label) == "humerus");
  for (int label = 71; label <= 74; ++label) CHECK(row(label) == "clavicle and scapula");
  for (int label = 75; label <= 76; ++label) CHECK(row(label) == "femur");
  for (int label = 77; label <= 78; ++label) CHECK(row(label) == "hip bone");
  CHECK(row(79) == "spinal cord");
  for (int label = 80; label <= 89; ++label) CHECK(row(label) == "muscle");
  CHECK(row(90) == "brain");
  CHECK(row(91) == "skull");
  for (int label = 92; label <= 115; ++label) CHECK(row(label) == "rib");
  CHECK(row(116) == "sternum");
  CHECK(row(117) == "cartilage");

  check_names(total_segmentator_sub_tasks());
}

TEST_CASE("tissue rows: the organs of ICRP Publication 110 are known, walls apart from what they hold") {
  CHECK(names_of(icrp_110_organs()).size() == 141);
  check_names(icrp_110_organs());
}

TEST_CASE(
    "tissue rows: names of Gabriel's tissues and of the Visible Human's voxel models are known, in any spelling") {
  check_names(visible_human_tissues());
  for (const char* name : {"unobtainium", "", "Segment_7"}) CHECK_MESSAGE(row_of(name) == "none", name);
}

TEST_CASE("tissue rows: a muscle named after a bone is muscle, and \"=head\" is no part of longer names") {
  for (const char* name : {"levator_scapulae_left", "Right levator scapulae", "levatores costarum",
                           "masseter of mandible", "serratus anterior, first rib"})
    CHECK_MESSAGE(row_of(name) == "muscle (kind)", name);
  for (const char* name : {"scapula_left", "Scapulae, cortical"}) CHECK_MESSAGE(row_of(name) != "muscle (kind)", name);
  CHECK(row_of("head of femur") == "femur");
  CHECK(row_of("Lateral head of triceps") == "muscle (kind)");
  CHECK(row_of("crown of first molar tooth") == "teeth");
  CHECK(row_of("ventricle_left") == "blood");
  CHECK(row_of("ventricle_body_left") == "cerebrospinal fluid");
}

TEST_CASE("tissue rows: every structure of BodyParts3D and of the SPL knee is known") {
  NEEDS_SHARED("data/bp3d/body_structures.labels.json");
  const TissueTable body = read_tissue_table(test::shared_path("data/bp3d/body_structures.labels.json"));
  check_known(body.tissues);
  for (const Tissue& tissue : body.tissues)
    if (tissue.kind == TissueKind::Muscle) {
      const TissueRow& row = tissue_rows().rows[tissue_rows().match(tissue).row];
      CHECK_MESSAGE(tissue_kind_from_name(row.names.name) != TissueKind::Bone, tissue.name);
    }
  TissueTable knee = read_tissue_table(test::shared_path("data/spl/knee.ctbl"));
  CHECK(knee.tissues.size() == 48);
  check_known(knee.tissues);
}

TEST_CASE("tissue rows: densities are those of the tissue, not of its kind, as their sources have them") {
  // Densities in kg/m3. ICRP 110: adult male, all 53 media, as in the Geant4 example ICRP110_HumanPhantoms. IT'IS:
  // means of its database, from its page on density in January 2026. ICRU 46: adult.
  const std::pair<const char*, double> densities[] = {{"teeth", 2750},
                                                      {"cortical bone", 1920},
                                                      {"Humeri, upper half, spongiosa", 1205},
                                                      {"Humeri, lower half, spongiosa", 1108},
                                                      {"Ulnae and radii, spongiosa", 1108},
                                                      {"Wrists and hand bones, spongiosa", 1108},
                                                      {"Clavicles, spongiosa", 1151},
                                                      {"Cranium, spongiosa", 1157},
                                                      {"Femora, upper half, spongiosa", 1124},
                                                      {"Femora, lower half, spongiosa", 1108},
                                                      {"Tibiae, fibulae and patellae, spongiosa", 1108},
                                                      {"Ankles and foot bones, spongiosa", 1108},
                                                      {"Mandible, spongiosa", 1228},
                                                      {"Pelvis, spongiosa", 1123},
                                                      {"Ribs, spongiosa", 1165},
                                                      {"Scapulae, spongiosa", 1183},
                                                      {"Cervical spine, spongiosa", 1050},
                                                      {"Thoracic spine, spongiosa", 1074},
                                                      {"Lumbar spine, spongiosa", 1112},
                                                      {"Sacrum, spongiosa", 1031},
                                                      {"Sternum, spongiosa", 1041},
                                                      {"Humeri, upper half, medullary cavity", 980},
                                                      {"Femora, lower half, medullary cavity", 980},
                                                      {"Ulnae and radii, medullary cavity", 980},
                                                      {"Tibiae, fibulae and patellae, medullary cavity", 980},
                                                      {"cartilage", 1100},
                                                      {"skin", 1090},
                                                      {"blood", 1060},
                                                      {"muscle", 1050},
                                                      {"liver", 1050},
                                                      {"pancreas", 1050},
                                                      {"brain", 1050},
                                                      {"Heart wall", 1050},
                                                      {"Eye bulb, left", 1050},
                                                      {"Kidney, left, cortex", 1050},
                                                      {"Stomach wall", 1040},
                                                      {"Small intestine wall", 1040},
                                                      {"Sigmoid colon wall", 1040},
                                                      {"spleen", 1040},
                                                      {"thyroid", 1040},
                                                      {"Urinary bladder wall", 1040},
                                                      {"Testis, left", 1040},
                                                      {"adrenal_gland_left", 1030},
                                                      {"Oesophagus (wall)", 1030},
                                                      {"Gall bladder wall", 1030},
                                                      {"Trachea", 1030},
                                                      {"Thymus", 1030},
                                                      {"Ureter, left", 1030},
                                                      {"prostate", 1030},
                                                      {"Lymphatic nodes, head", 1030},
                                                      {"Breast, left, glandular tissue", 1020},
                                                      {"Breast, left, adipose tissue", 950},
                                                      {"adipose", 950},
                                                      {"lung_upper_lobe_left", 382},
                                                      {"stomach contents", 1040},
                                                      {"urine", 1040},
                                                      {"air", 1},  // up to here from ICRP 110
                                                      {"csf", 1007},
                                                      {"grey matter", 1045},
                                                      {"white matter", 1041},
                                                      {"cerebellum_left", 1045},
                                                      {"tendon", 1142},
                                                      {"nerve", 1075},
                                                      {"dura", 1174},
                                                      {"vessel wall", 1102},
                                                      {"sclera", 1032},
                                                      {"cornea", 1062},
                                                      {"eye_lens_left", 1076},
                                                      {"vitreous humour", 1005},  // up to here from IT'IS
                                                      {"vertebrae_L3", 1330},
                                                      {"vertebrae_C4", 1420},
                                                      {"skull", 1610},
                                                      {"mandible", 1680},
                                                      {"femur_left", 1420},
                                                      {"sternum", 1250},
                                                      {"sacrum", 1290},
                                                      {"cancellous bone", 1180}};  // from ICRU 46
  for (const auto& [name, density] : densities)
    CHECK_MESSAGE(tissue_named(name).density == doctest::Approx(density / 1000), name);
  CHECK(usual_density(tissue_named("liver")).row == "liver");
  CHECK(usual_density(tissue_named("liver")).source.find("ICRP") != std::string::npos);
  CHECK(usual_density(tissue_named("unobtainium")).row.empty());
  for (const TissueRow& row : tissue_rows().rows) CHECK_MESSAGE(row.source.size() > 10, row.names.name);
}

TEST_CASE(
    "tissue rows: a mixture without shares has those of its density, and a damaged table is refused with its line") {
  const std::string columns = "name,names,kinds,density,dielectric,medium,mixture,stand_in,source\n";
  const std::string parts = "a,,,2000,x,y,,,s\nb,,,1000,x,y,,,s\n";
  const TissueRows table =
      parse_tissue_rows(columns + parts + "c,,,1250,,,a + b,,s\nd,,,1500,,,0.9 a + 0.1 b,,s\n", "t");
  REQUIRE(table.rows.size() == 4);
  CHECK(table.rows[2].mixture[0].volume == doctest::Approx(0.25));
  CHECK(table.rows[2].mixture[1].row == 1);
  CHECK(table.rows[3].mixture[0].volume == 0.9);
  CHECK(table.parts(0).front().volume == 1);
  for (const char* row : {"c,,,900,,,a + b,,s", "c,,,1500,,,a + e,,s", "c,,,1500,,,0.5 a + 0.4 b,,s", "c,,,0,x,y,,,s",
                          "c,,,1,x,y,,,", "c,,,1,x,y", "c,,plastic,1,x,y,,,s", "c,,,1500,,,0.5 a + b,,s"})
    CHECK_THROWS_WITH_AS(parse_tissue_rows(columns + parts + row + "\n", "t"), doctest::Contains("t line 4"), Error);
  CHECK_THROWS_AS(parse_tissue_rows("a,b\n", "t"), Error);
}

TEST_CASE("tissue rows: media of mixtures go by the masses of their parts") {
  const CompositionTable media = read_composition_table();
  TissueTable table;
  for (const char* name : {"vertebrae_L3", "cortical bone", "cancellous bone"})
    table.tissues.push_back(tissue_named(name));
  const std::vector<int> rows = media_of(table, media, "test");
  const double cortical = (1.33 - 1.18) / (1.92 - 1.18), mass = cortical * 1.92 / 1.33;
  for (std::size_t i = 0; i < kElements.size(); ++i)
    CHECK(media.shares[rows[0]][i] ==
          doctest::Approx(mass * media.shares[rows[1]][i] + (1 - mass) * media.shares[rows[2]][i]));
  CHECK(media.names[rows[0]].name == "20 % mineral bone + 80 % spongiosa");
}
