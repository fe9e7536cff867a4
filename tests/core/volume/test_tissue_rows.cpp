// SPDX-License-Identifier: AGPL-3.0-or-later
// The one table of tissues: names of the label tables that are in use, densities as their sources have them, mixtures.
#include "core/volume/tissue_rows.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/volume/composition.h"
#include "core/volume/dielectric.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {

Tissue tissue_named(const std::string& name) {
  Tissue tissue;
  tissue.name = name;
  tissue.kind = tissue_kind_from_name(name);
  apply_kind_defaults(tissue);
  return tissue;
}

// "kidney", "muscle (kind)", "none"
std::string row_of(const std::string& name) {
  const TissueMatch match = tissue_rows().match(tissue_named(name));
  return match.row < 0 ? "none" : tissue_rows().rows[match.row].names.name + (match.by_name ? "" : " (kind)");
}

using Expected = std::vector<std::pair<const char*, std::vector<const char*>>>;  // a row, then names that are it

void check_rows(const Expected& expected) {
  for (const auto& [row, names] : expected)
    for (const char* name : names) CHECK_MESSAGE(row_of(name) == std::string(row), name);
}

// Every name has permittivity, a density with its source, and elements.
void check_known(const std::vector<Tissue>& tissues) {
  TissueTable table;
  table.tissues = tissues;
  for (std::size_t i = 0; i < tissues.size(); ++i) table.tissues[i].label = static_cast<Label>(i + 1);
  const TissueMaterials found = tissue_materials(table, read_dielectric_table(), 900e6);
  CHECK_MESSAGE(found.unmatched.empty(), doctest::String(found.unmatched.empty() ? "" :
      found.unmatched.front().c_str()));
  for (const TissueMaterial& material : found.materials) {
    CHECK_MESSAGE(material.density_source.size() > 10, material.name);
    CHECK_MESSAGE(material.found.find(": ") != std::string::npos, material.name);
  }
  CHECK(media_of(table, read_composition_table(), "test").size() == tissues.size());
}

void check_names_known(const Expected& expected) {
  std::vector<Tissue> tissues;
  for (const auto& [row, names] : expected)
    for (const char* name : names) tissues.push_back(tissue_named(name));
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
  const auto row = [&](int label) { return
      tissue_rows().rows[tissue_rows().match(*total.find(static_cast<Label>(label))).row].names.name; };
  const std::vector<const char*> first = {"spleen", "kidney", "kidney", "gall bladder", "liver", "stomach",
      "pancreas", "adrenal gland", "adrenal gland", "lung", "lung", "lung",
                                          "lung", "lung", "oesophagus", "trachea", "thyroid", "small intestine",
                                              "duodenum", "colon", "urinary bladder", "prostate",
                                          "cyst or effusion", "cyst or effusion", "sacrum", "sacrum"};
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

  const Expected others = {
      {"muscle", {"skeletal_muscle", "superior_pharyngeal_constrictor", "prevertebral_left", "sterno_thyroid_right",
          "thigh_medial_compartment_left", "coracobrachial", "soft_palate"}},
      {"muscle (kind)", {"masseter_right", "teres_major", "levator_palpebrae_superioris_left",
          "quadriceps_femoris_left", "digastric_left"}},
      {"tongue", {"tongue"}}, {"fat", {"subcutaneous_fat", "torso_fat"}}, {"fat infiltrated", {"intermuscular_fat"}},
      {"blood", {"lung_vessels", "liver_vessels", "coronary_arteries", "heart_atrium_left", "heart_ventricle_right",
          "pulmonary_artery", "venous_sinuses", "intracerebral_hemorrhage",
                 "internal_carotid_artery_right", "internal_jugular_vein_left", "left_ventricular_outflow_tract",
                     "non_coronary_cusp"}},
      {"heart", {"heart_myocardium"}}, {"gas", {"larynx_air", "nasopharynx", "oropharynx", "hypopharynx",
          "nasal_cavity_left", "auditory_canal_left"}},
      {"brain", {"brainstem", "frontal_lobe", "central_sulcus"}}, {"cerebellum", {"cerebellum"}}, {"white matter",
          {"internal_capsule", "septum_pellucidum"}},
      {"grey matter", {"caudate_nucleus", "lentiform_nucleus", "insular_cortex", "thalamus"}},
      {"cerebrospinal fluid", {"subarachnoid_space", "ventricle", "third_ventricle", "ventricle_frontal_horn_left"}},
      {"gland", {"parotid_gland_left", "submandibular_gland_right"}}, {"eye", {"eye_left", "eyeball_right"}},
          {"eye lens", {"eye_lens_right"}},
      {"nerve", {"optic_nerve_left"}}, {"skull", {"hard_palate", "zygomatic_arch_left", "hyoid",
          "styloid_process_left"}},
      {"cartilage", {"thyroid_cartilage", "cricoid_cartilage", "intervertebral_discs"}}, {"vertebra", {"vertebrae",
          "vertebrae_body"}},
      {"bone", {"patella", "tibia", "fibula", "tarsal", "metatarsal", "phalanges_feet", "ulna", "radius", "carpal",
          "metacarpal", "phalanges_hand"}},
      {"soft tissue", {"body_trunc", "body_extremities", "face"}}, {"lung", {"lung_left"}}, {"lung deflated",
          {"lung_nodules", "lung_covid_infiltrate"}},
      {"liver", {"liver_segment_3", "liver_tumor"}}, {"breast", {"breast"}}, {"cyst or effusion", {"pleural_effusion",
          "pericardial_effusion"}}};
  check_rows(others);
  check_names_known(others);
  CHECK(row_of("hip_implant") == "implant");  // no tissue: it has no properties here
}

TEST_CASE("tissue rows: the organs of ICRP Publication 110 are known, walls apart from what they hold") {
  const Expected organs = {
      {"adrenal gland", {"Adrenal, left", "Adrenal, right"}},
      {"mucous membrane", {"Anterior nasal passage (ET1)", "Posterior nasal passage down to larynx (ET2)",
          "Oral mucosa, tongue", "Oral mucosa, lips and cheeks"}},
      {"trachea", {"Trachea"}}, {"bronchi", {"Bronchi"}}, {"blood", {"Blood vessels, head", "Blood vessels, legs",
          "Heart contents (blood)", "Lung, left, blood", "Lung, right, blood"}},
      {"cortical bone", {"Humeri, upper half, cortical", "Ulnae and radii, cortical",
          "Wrists and hand bones, cortical", "Clavicles, cortical", "Cranium, cortical",
          "Femora, lower half, cortical",
                         "Tibiae, fibulae and patellae, cortical", "Ankles and foot bones, cortical",
                             "Mandible, cortical", "Pelvis, cortical", "Ribs, cortical", "Scapulae, cortical",
                         "Cervical spine, cortical", "Thoracic spine, cortical", "Lumbar spine, cortical",
                             "Sacrum, cortical", "Sternum, cortical"}},
      {"spongiosa of the humerus, upper half", {"Humeri, upper half, spongiosa"}},
          {"spongiosa of the humerus, lower half", {"Humeri, lower half, spongiosa"}},
      {"spongiosa of the forearm", {"Ulnae and radii, spongiosa"}}, {"spongiosa of the hand",
          {"Wrists and hand bones, spongiosa"}},
      {"spongiosa of the collarbone", {"Clavicles, spongiosa"}}, {"spongiosa of the skull", {"Cranium, spongiosa"}},
          {"spongiosa of the femur, upper half", {"Femora, upper half, spongiosa"}},
      {"spongiosa of the femur, lower half", {"Femora, lower half, spongiosa"}}, {"spongiosa of the lower leg",
          {"Tibiae, fibulae and patellae, spongiosa"}},
      {"spongiosa of the foot", {"Ankles and foot bones, spongiosa"}}, {"spongiosa of the mandible",
          {"Mandible, spongiosa"}}, {"spongiosa of the pelvis", {"Pelvis, spongiosa"}},
      {"spongiosa of the ribs", {"Ribs, spongiosa"}}, {"spongiosa of the shoulder blade", {"Scapulae, spongiosa"}},
          {"spongiosa of the cervical spine", {"Cervical spine, spongiosa"}},
      {"spongiosa of the thoracic spine", {"Thoracic spine, spongiosa"}}, {"spongiosa of the lumbar spine",
          {"Lumbar spine, spongiosa"}}, {"spongiosa of the sacrum", {"Sacrum, spongiosa"}},
      {"spongiosa of the sternum", {"Sternum, spongiosa"}},
      {"marrow", {"Humeri, upper half, medullary cavity", "Ulnae and radii, medullary cavity",
          "Femora, lower half, medullary cavity", "Tibiae, fibulae and patellae, medullary cavity"}},
      {"cartilage", {"Cartilage, head", "Cartilage, trunk", "Cartilage, arms", "Cartilage, legs"}}, {"brain",
          {"Brain"}},
      {"breast fat", {"Breast, left, adipose tissue"}}, {"breast gland", {"Breast, right, glandular tissue"}},
          {"eye lens", {"Eye lens, left"}}, {"eye", {"Eye bulb, right"}},
      {"gall bladder", {"Gall bladder wall"}}, {"bile", {"Gall bladder contents"}}, {"stomach", {"Stomach wall"}},
          {"stomach contents", {"Stomach contents"}},
      {"small intestine", {"Small intestine wall"}},
      {"intestine contents", {"Small intestine contents", "Ascending colon contents",
          "Transverse colon contents, right", "Transverse colon contents, left", "Descending colon contents",
                              "Sigmoid colon contents"}},
      {"colon", {"Ascending colon wall", "Transverse colon wall, left", "Sigmoid colon wall", "Rectum wall"}},
          {"heart", {"Heart wall"}},
      {"kidney", {"Kidney, left, cortex", "Kidney, left, medulla", "Kidney, right, pelvis"}}, {"liver", {"Liver"}},
          {"lung", {"Lung, left, tissue", "Lung, right, tissue"}},
      {"lymph node", {"Lymphatic nodes, extrathoracic airways", "Lymphatic nodes, arms"}}, {"muscle", {"Muscle, head",
          "Muscle, legs"}}, {"oesophagus", {"Oesophagus (wall)"}},
      {"ovary", {"Ovary, left"}}, {"pancreas", {"Pancreas"}}, {"gland", {"Pituitary gland", "Salivary glands, left",
          "Tonsils"}}, {"prostate", {"Prostate"}},
      {"fat", {"Residual tissue, head", "Residual tissue, legs"}}, {"skin", {"Skin, head", "Skin at top and bottom"}},
          {"spinal cord", {"Spinal cord"}}, {"spleen", {"Spleen"}},
      {"teeth", {"Teeth"}}, {"testis", {"Testis, left"}}, {"thymus", {"Thymus"}}, {"thyroid", {"Thyroid"}}, {"tongue",
          {"Tongue (inner part)"}}, {"ureter", {"Ureter, left"}},
      {"urinary bladder", {"Urinary bladder wall"}}, {"urine", {"Urinary bladder contents"}}, {"uterus",
          {"Uterus / Cervix"}}, {"gas", {"Air inside body"}}};
  check_rows(organs);
  check_names_known(organs);
}

TEST_CASE("tissue rows: names of Gabriel's tissues and of the Visible Human's voxel models are known, in any spelling") {
  const Expected names = {
      {"blood", {"Aorta", "Blood", "BloodVessel"}}, {"vessel wall", {"vessel wall"}}, {"urinary bladder",
          {"Bladder"}}, {"cancellous bone", {"Bone (Cancellous)", "BoneCancellous"}},
      {"cortical bone", {"Bone (Cortical)", "BoneCortical"}}, {"red marrow", {"Bone Marrow (Infiltrated)"}},
          {"marrow", {"Bone Marrow (Not Infiltrated)", "BoneMarrow"}},
      {"grey matter", {"Brain (Grey Matter)", "BrainGreyMatter"}}, {"white matter", {"Brain (White Matter)",
          "BrainWhiteMatter"}}, {"breast fat", {"Breast fat", "BreastFat"}},
      {"cartilage", {"Cartilage"}}, {"cerebellum", {"Cerebellum"}}, {"cerebrospinal fluid", {"Cerebro Spinal Fluid",
          "CerebroSpinalFluid", "CSF"}}, {"cervix", {"Cervix"}}, {"colon", {"Colon"}},
      {"cornea", {"Cornea"}}, {"dura", {"Dura"}}, {"sclera", {"Eye Tissues (Sclera)", "EyeSclera"}},
          {"fat infiltrated", {"Fat (Average Infiltrated)"}}, {"fat", {"Fat (Not Infiltrated)", "Fat"}},
      {"gall bladder", {"Gall Bladder", "GallBladder"}}, {"bile", {"Gall Bladder Bile", "GallBladderBile"}}, {"heart",
          {"Heart"}}, {"kidney", {"Kidney"}}, {"lens cortex", {"Lens Cortex"}},
      {"lens nucleus", {"Lens Nucleus"}}, {"eye lens", {"Lens"}}, {"liver", {"Liver"}}, {"lung deflated",
          {"Lung (Deflated)", "LungDeflated"}}, {"lung", {"Lung (Inflated)", "LungInflated"}},
      {"muscle", {"Muscle"}}, {"nerve", {"Nerve"}}, {"ovary", {"Ovary"}}, {"skin", {"Skin (Dry)", "SkinDry"}},
          {"mucous membrane", {"Skin (Wet)", "SkinWet", "MucousMembrane"}},
      {"small intestine", {"Small Intestine", "SmallIntestine"}}, {"spleen", {"Spleen"}}, {"stomach", {"Stomach"}},
          {"tendon", {"Tendon"}}, {"testis", {"Testis"}}, {"thyroid", {"Thyroid"}},
      {"tongue", {"Tongue"}}, {"trachea", {"Trachea"}}, {"uterus", {"Uterus"}}, {"vitreous humour", {"Vitreous Humor",
          "VitreousHumor", "BodyFluid"}}, {"gas", {"Air"}}, {"duodenum", {"Duodenum"}},
      {"gland", {"Gland"}}, {"lymph node", {"Lymph"}}, {"nail", {"Nail", "toenail"}}, {"oesophagus", {"Oesophagus",
          "esophagus"}}, {"pancreas", {"Pancreas"}}, {"prostate", {"Prostate"}},
      {"retina", {"Retina"}}, {"spinal cord", {"SpinalCord"}}, {"thymus", {"Thymus"}}, {"teeth", {"Tooth"}}};
  check_rows(names);
  check_names_known(names);
  for (const char* name : {"unobtainium", "", "Segment_7"}) CHECK_MESSAGE(row_of(name) == "none", name);
}

TEST_CASE("tissue rows: every structure of BodyParts3D and of the SPL knee is known") {
  NEEDS_SHARED("data/bp3d/body_structures.labels.json");
  check_known(read_tissue_table(test::shared_path("data/bp3d/body_structures.labels.json")).tissues);
  TissueTable knee = read_tissue_table(test::shared_path("data/spl/knee.ctbl"));
  CHECK(knee.tissues.size() == 48);
  check_known(knee.tissues);
}

TEST_CASE("tissue rows: densities are those of the tissue, not of its kind, as their sources have them") {
  // kg/m3. ICRP 110: adult male. ICRU 46: adult. IT'IS: means of its database.
  const std::pair<const char*, double> densities[] = {
      {"lung_upper_lobe_left", 382},  // ICRP 110, with its air
      {"csf", 1007},                  // IT'IS
      {"teeth", 2750}, {"blood", 1060}, {"muscle", 1050}, {"adipose", 950}, {"skin", 1090}, {"cartilage", 1100},
          {"cortical bone", 1920}, {"liver", 1050}, {"spleen", 1040},
      {"adrenal_gland_left", 1030}, {"urine", 1040}, {"stomach contents", 1040}, {"air", 1}, {"Cranium, spongiosa",
          1157}, {"Sacrum, spongiosa", 1031}, {"medullary cavity", 980}, // ICRP 110
      {"vertebrae_L3", 1330}, {"vertebrae_C4", 1420}, {"skull", 1610}, {"mandible", 1680}, {"femur_left", 1420},
          {"sternum", 1250}, {"sacrum", 1290}, {"cancellous bone", 1180}, // ICRU 46
      {"grey matter", 1045}, {"tendon", 1142}, {"nerve", 1075}, {"dura", 1174}};  // IT'IS
  for (const auto& [name, density] : densities) CHECK_MESSAGE(tissue_named(name).density == doctest::Approx(density /
      1000), name);
  CHECK(usual_density(tissue_named("liver")).row == "liver");
  CHECK(usual_density(tissue_named("liver")).source.find("ICRP") != std::string::npos);
  CHECK(usual_density(tissue_named("unobtainium")).row.empty());
  for (const TissueRow& row : tissue_rows().rows) CHECK_MESSAGE(row.source.size() > 10, row.names.name);
}

TEST_CASE("tissue rows: a mixture without shares has those of its density, and a damaged table is refused with its line") {
  const std::string columns = "name,names,kinds,density,dielectric,medium,mixture,stand_in,source\n";
  const std::string parts = "a,,,2000,x,y,,,s\nb,,,1000,x,y,,,s\n";
  const TissueRows table = parse_tissue_rows(columns + parts + "c,,,1250,,,a + b,,s\nd,,,1500,,,0.9 a + 0.1 b,,s\n",
      "t");
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
    CHECK(media.shares[rows[0]][i] == doctest::Approx(mass * media.shares[rows[1]][i] + (1 - mass) *
        media.shares[rows[2]][i]));
  CHECK(media.names[rows[0]].name == "20 % mineral bone + 80 % spongiosa");
}
