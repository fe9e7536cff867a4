// SPDX-License-Identifier: AGPL-3.0-or-later
// Names of the label tables that are in use, each with the row of tissues.csv that it is: what the product says it
// knows. "muscle (kind)" is a row that the name's kind, and no word of it, leads to.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace limber::test {

using NamesOfRow = std::pair<std::string, std::vector<std::string>>;  // a row, then names that are it

// TotalSegmentator's 77 classes of teeth: crowns of the teeth by the numbers of the FDI, and their pulps.
inline void add_teeth(std::vector<NamesOfRow>& rows) {
  const std::vector<std::string> teeth = {"central_incisor", "lateral_incisor", "canine", "first_premolar",
                                          "second_premolar", "first_molar", "second_molar", "third_molar"};
  const std::vector<std::string> quarters = {"upper_right", "upper_left", "lower_left", "lower_right"};
  NamesOfRow hard{"teeth", {}}, pulps{"soft tissue", {}};
  for (std::size_t quarter = 0; quarter < 4; ++quarter)
    for (std::size_t tooth = 0; tooth < 8; ++tooth) {
      const std::string name = quarters[quarter] + "_" + teeth[tooth];
      const std::string number = std::to_string(10 * (quarter + 1) + tooth + 1);
      hard.second.push_back(name + "_fdi" + number);
      pulps.second.push_back(name + "_pulp_fdi1" + number);
    }
  rows.push_back(hard);
  rows.push_back(pulps);
}

// Every class of TotalSegmentator's other tasks [Wasserthal et al. 2023; its map_to_binary.py and README of 2026].
inline std::vector<NamesOfRow> total_segmentator_sub_tasks() {
  std::vector<NamesOfRow> rows = {
      {"muscle",
       {"skeletal_muscle", "superior_pharyngeal_constrictor", "middle_pharyngeal_constrictor",
        "inferior_pharyngeal_constrictor", "prevertebral_left", "prevertebral_right", "sterno_thyroid_left",
        "sterno_thyroid_right", "thyrohyoid_left", "thyrohyoid_right", "thigh_medial_compartment_left",
        "thigh_medial_compartment_right", "thigh_posterior_compartment_left", "thigh_posterior_compartment_right",
        "coracobrachial", "soft_palate", "lateral_rectus_muscle_right", "superior_oblique_muscle_right",
        "superior_rectus_muscle_right", "medial_rectus_muscle_left", "inferior_oblique_muscle_right",
        "inferior_rectus_muscle_right", "lateral_rectus_muscle_left", "superior_oblique_muscle_left",
        "superior_rectus_muscle_left", "medial_rectus_muscle_right", "inferior_oblique_muscle_left",
        "inferior_rectus_muscle_left"}},
      {"muscle (kind)",
       {"masseter_right", "masseter_left", "temporalis_right", "temporalis_left", "lateral_pterygoid_right",
        "lateral_pterygoid_left", "medial_pterygoid_right", "medial_pterygoid_left", "digastric_right",
        "digastric_left", "teres_major", "levator_palpebrae_superioris_left", "levator_palpebrae_superioris_right",
        "quadriceps_femoris_left", "quadriceps_femoris_right", "sternocleidomastoid_right",
        "sternocleidomastoid_left", "trapezius_right", "trapezius_left", "platysma_right", "platysma_left",
        "levator_scapulae_right", "levator_scapulae_left", "anterior_scalene_right", "anterior_scalene_left",
        "middle_scalene_right", "middle_scalene_left", "posterior_scalene_right", "posterior_scalene_left",
        "sartorius_left", "sartorius_right", "deltoid", "supraspinatus", "infraspinatus", "subscapularis", "trapezius",
        "pectoralis_minor", "serratus_anterior", "triceps_brachii", "pectoralis_major_right", "pectoralis_major_left",
        "rectus_abdominis_right", "rectus_abdominis_left", "serratus_anterior_right", "serratus_anterior_left",
        "latissimus_dorsi_right", "latissimus_dorsi_left", "external_oblique_right", "external_oblique_left",
        "internal_oblique_right", "internal_oblique_left", "erector_spinae_right", "erector_spinae_left",
        "transversospinalis_right", "transversospinalis_left", "psoas_major_right", "psoas_major_left",
        "quadratus_lumborum_right", "quadratus_lumborum_left"}},
      {"tongue", {"tongue"}},
      {"fat", {"subcutaneous_fat", "torso_fat"}},
      {"fat infiltrated", {"intermuscular_fat"}},
      {"blood",
       {"lung_vessels", "liver_vessels", "coronary_arteries", "heart_atrium_left", "heart_atrium_right",
        "heart_ventricle_left", "heart_ventricle_right", "atrium_left", "ventricle_left", "atrium_right",
        "ventricle_right", "pulmonary_artery", "venous_sinuses", "intracerebral_hemorrhage", "brain_aneurysm",
        "internal_carotid_artery_right", "internal_carotid_artery_left", "internal_jugular_vein_right",
        "internal_jugular_vein_left", "left_ventricular_outflow_tract", "right_coronary_cusp", "left_coronary_cusp",
        "non_coronary_cusp"}},
      {"heart", {"heart_myocardium", "myocardium"}},
      {"gas",
       {"larynx_air", "nasopharynx", "oropharynx", "hypopharynx", "pharynx", "nasal_cavity_left", "nasal_cavity_right",
        "auditory_canal_left", "auditory_canal_right", "sinus_maxillary", "sinus_frontal", "left_maxillary_sinus",
        "right_maxillary_sinus"}},
      {"brain",
       {"brainstem", "frontal_lobe", "parietal_lobe", "occipital_lobe", "temporal_lobe", "central_sulcus"}},
      {"cerebellum", {"cerebellum"}},
      {"white matter", {"internal_capsule", "septum_pellucidum"}},
      {"grey matter", {"caudate_nucleus", "lentiform_nucleus", "insular_cortex", "thalamus"}},
      {"cerebrospinal fluid",
       {"subarachnoid_space", "ventricle", "third_ventricle", "fourth_ventricle", "ventricle_frontal_horn_left",
        "ventricle_occipital_horn_left", "ventricle_body_left", "ventricle_temporal_horn_left",
        "ventricle_trigone_left", "ventricle_frontal_horn_right", "ventricle_occipital_horn_right",
        "ventricle_body_right", "ventricle_temporal_horn_right", "ventricle_trigone_right"}},
      {"gland",
       {"parotid_gland_left", "parotid_gland_right", "submandibular_gland_left", "submandibular_gland_right"}},
      {"eye", {"eye_left", "eye_right", "eyeball_left", "eyeball_right"}},
      {"eye lens", {"eye_lens_left", "eye_lens_right"}},
      {"nerve",
       {"optic_nerve_left", "optic_nerve_right", "left_inferior_alveolar_canal", "right_inferior_alveolar_canal",
        "left_mandibular_incisive_canal_fdi103", "right_mandibular_incisive_canal_fdi104", "lingual_canal"}},
      {"skull",
       {"hard_palate", "zygomatic_arch_left", "zygomatic_arch_right", "hyoid", "styloid_process_left",
        "styloid_process_right", "skull", "upper_jawbone"}},
      {"mandible", {"mandible", "lower_jawbone"}},
      {"teeth", {"teeth_lower", "teeth_upper"}},
      {"cartilage", {"thyroid_cartilage", "cricoid_cartilage", "intervertebral_discs"}},
      {"vertebra", {"vertebrae", "vertebrae_body"}},
      {"bone",
       {"patella", "tibia", "fibula", "tarsal", "metatarsal", "phalanges_feet", "ulna", "radius", "carpal",
        "metacarpal", "phalanges_hand"}},
      {"humerus", {"humerus"}},
      {"femur", {"femur"}},
      {"soft tissue",
       {"body_trunc", "body_extremities", "face", "face_region", "head", "mediastinum", "pericardium"}},
      {"body cavity (kind)", {"abdominal_cavity", "thoracic_cavity"}},
      {"lung", {"lung", "lung_left", "lung_right"}},
      {"lung deflated", {"lung_nodules", "lung_covid_infiltrate"}},
      {"bronchi", {"lung_trachea_bronchia"}},
      {"liver",
       {"liver_segment_1", "liver_segment_2", "liver_segment_3", "liver_segment_4", "liver_segment_5",
        "liver_segment_6", "liver_segment_7", "liver_segment_8", "liver_tumor"}},
      {"breast", {"breast"}},
      {"cyst or effusion", {"kidney_cyst_left", "kidney_cyst_right", "pleural_effusion", "pericardial_effusion"}},
      {"implant", {"hip_implant", "implant", "bridge", "crown"}}};
  add_teeth(rows);
  return rows;
}

// The 141 organs of the adult male and female of ICRP Publication 110 (2009).
inline std::vector<NamesOfRow> icrp_110_organs() {
  return {
      {"adrenal gland", {"Adrenal, left", "Adrenal, right"}},
      {"mucous membrane",
       {"Anterior nasal passage (ET1)", "Posterior nasal passage down to larynx (ET2)", "Oral mucosa, tongue",
        "Oral mucosa, lips and cheeks"}},
      {"trachea", {"Trachea"}},
      {"bronchi", {"Bronchi"}},
      {"blood",
       {"Blood vessels, head", "Blood vessels, legs", "Heart contents (blood)", "Lung, left, blood",
        "Lung, right, blood", "Blood vessels, trunk", "Blood vessels, arms"}},
      {"cortical bone",
       {"Humeri, upper half, cortical", "Ulnae and radii, cortical", "Wrists and hand bones, cortical",
        "Clavicles, cortical", "Cranium, cortical", "Femora, lower half, cortical",
        "Tibiae, fibulae and patellae, cortical", "Ankles and foot bones, cortical", "Mandible, cortical",
        "Pelvis, cortical", "Ribs, cortical", "Scapulae, cortical", "Cervical spine, cortical",
        "Thoracic spine, cortical", "Lumbar spine, cortical", "Sacrum, cortical", "Sternum, cortical",
        "Humeri, lower half, cortical", "Femora, upper half, cortical"}},
      {"spongiosa of the humerus, upper half", {"Humeri, upper half, spongiosa"}},
      {"spongiosa of the humerus, lower half", {"Humeri, lower half, spongiosa"}},
      {"spongiosa of the forearm", {"Ulnae and radii, spongiosa"}},
      {"spongiosa of the hand", {"Wrists and hand bones, spongiosa"}},
      {"spongiosa of the collarbone", {"Clavicles, spongiosa"}},
      {"spongiosa of the skull", {"Cranium, spongiosa"}},
      {"spongiosa of the femur, upper half", {"Femora, upper half, spongiosa"}},
      {"spongiosa of the femur, lower half", {"Femora, lower half, spongiosa"}},
      {"spongiosa of the lower leg", {"Tibiae, fibulae and patellae, spongiosa"}},
      {"spongiosa of the foot", {"Ankles and foot bones, spongiosa"}},
      {"spongiosa of the mandible", {"Mandible, spongiosa"}},
      {"spongiosa of the pelvis", {"Pelvis, spongiosa"}},
      {"spongiosa of the ribs", {"Ribs, spongiosa"}},
      {"spongiosa of the shoulder blade", {"Scapulae, spongiosa"}},
      {"spongiosa of the cervical spine", {"Cervical spine, spongiosa"}},
      {"spongiosa of the thoracic spine", {"Thoracic spine, spongiosa"}},
      {"spongiosa of the lumbar spine", {"Lumbar spine, spongiosa"}},
      {"spongiosa of the sacrum", {"Sacrum, spongiosa"}},
      {"spongiosa of the sternum", {"Sternum, spongiosa"}},
      {"marrow",
       {"Humeri, upper half, medullary cavity", "Ulnae and radii, medullary cavity",
        "Femora, lower half, medullary cavity", "Tibiae, fibulae and patellae, medullary cavity",
        "Humeri, lower half, medullary cavity", "Femora, upper half, medullary cavity"}},
      {"cartilage", {"Cartilage, head", "Cartilage, trunk", "Cartilage, arms", "Cartilage, legs"}},
      {"brain", {"Brain"}},
      {"breast fat", {"Breast, left, adipose tissue", "Breast, right, adipose tissue"}},
      {"breast gland", {"Breast, right, glandular tissue", "Breast, left, glandular tissue"}},
      {"eye lens", {"Eye lens, left", "Eye lens, right"}},
      {"eye", {"Eye bulb, right", "Eye bulb, left"}},
      {"gall bladder", {"Gall bladder wall"}},
      {"bile", {"Gall bladder contents"}},
      {"stomach", {"Stomach wall"}},
      {"stomach contents", {"Stomach contents"}},
      {"small intestine", {"Small intestine wall"}},
      {"intestine contents",
       {"Small intestine contents", "Ascending colon contents", "Transverse colon contents, right",
        "Transverse colon contents, left", "Descending colon contents", "Sigmoid colon contents"}},
      {"colon",
       {"Ascending colon wall", "Transverse colon wall, left", "Sigmoid colon wall", "Rectum wall",
        "Transverse colon wall, right", "Descending colon wall"}},
      {"heart", {"Heart wall"}},
      {"kidney",
       {"Kidney, left, cortex", "Kidney, left, medulla", "Kidney, right, pelvis", "Kidney, left, pelvis",
        "Kidney, right, cortex", "Kidney, right, medulla"}},
      {"liver", {"Liver"}},
      {"lung", {"Lung, left, tissue", "Lung, right, tissue"}},
      {"lymph node",
       {"Lymphatic nodes, extrathoracic airways", "Lymphatic nodes, arms", "Lymphatic nodes, thoracic airways",
        "Lymphatic nodes, head", "Lymphatic nodes, trunk", "Lymphatic nodes, legs"}},
      {"muscle", {"Muscle, head", "Muscle, legs", "Muscle, trunk", "Muscle, arms"}},
      {"oesophagus", {"Oesophagus (wall)"}},
      {"ovary", {"Ovary, left", "Ovary, right"}},
      {"pancreas", {"Pancreas"}},
      {"gland", {"Pituitary gland", "Salivary glands, left", "Tonsils", "Salivary glands, right"}},
      {"prostate", {"Prostate"}},
      {"fat", {"Residual tissue, head", "Residual tissue, legs", "Residual tissue, trunk", "Residual tissue, arms"}},
      {"skin", {"Skin, head", "Skin at top and bottom", "Skin, trunk", "Skin, arms", "Skin, legs"}},
      {"spinal cord", {"Spinal cord"}},
      {"spleen", {"Spleen"}},
      {"teeth", {"Teeth"}},
      {"testis", {"Testis, left", "Testis, right"}},
      {"thymus", {"Thymus"}},
      {"thyroid", {"Thyroid"}},
      {"tongue", {"Tongue (inner part)"}},
      {"ureter", {"Ureter, left", "Ureter, right"}},
      {"urinary bladder", {"Urinary bladder wall"}},
      {"urine", {"Urinary bladder contents"}},
      {"uterus", {"Uterus / Cervix"}},
      {"gas", {"Air inside body"}}};
}

// Gabriel's tissues as the IFAC-CNR calculator spells them, and those of the Visible Human's voxel models.
inline std::vector<NamesOfRow> visible_human_tissues() {
  return {
      {"blood", {"Aorta", "Blood", "BloodVessel"}},
      {"vessel wall", {"vessel wall"}},
      {"urinary bladder", {"Bladder"}},
      {"cancellous bone", {"Bone (Cancellous)", "BoneCancellous"}},
      {"cortical bone", {"Bone (Cortical)", "BoneCortical"}},
      {"red marrow", {"Bone Marrow (Infiltrated)"}},
      {"marrow", {"Bone Marrow (Not Infiltrated)", "BoneMarrow"}},
      {"grey matter", {"Brain (Grey Matter)", "BrainGreyMatter"}},
      {"white matter", {"Brain (White Matter)", "BrainWhiteMatter"}},
      {"breast fat", {"Breast fat", "BreastFat"}},
      {"cartilage", {"Cartilage"}},
      {"cerebellum", {"Cerebellum"}},
      {"cerebrospinal fluid", {"Cerebro Spinal Fluid", "CerebroSpinalFluid", "CSF"}},
      {"cervix", {"Cervix"}},
      {"colon", {"Colon"}},
      {"cornea", {"Cornea"}},
      {"dura", {"Dura"}},
      {"sclera", {"Eye Tissues (Sclera)", "EyeSclera"}},
      {"fat infiltrated", {"Fat (Average Infiltrated)"}},
      {"fat", {"Fat (Not Infiltrated)", "Fat"}},
      {"gall bladder", {"Gall Bladder", "GallBladder"}},
      {"bile", {"Gall Bladder Bile", "GallBladderBile"}},
      {"heart", {"Heart"}},
      {"kidney", {"Kidney"}},
      {"lens cortex", {"Lens Cortex"}},
      {"lens nucleus", {"Lens Nucleus"}},
      {"eye lens", {"Lens"}},
      {"liver", {"Liver"}},
      {"lung deflated", {"Lung (Deflated)", "LungDeflated"}},
      {"lung", {"Lung (Inflated)", "LungInflated"}},
      {"muscle", {"Muscle"}},
      {"nerve", {"Nerve"}},
      {"ovary", {"Ovary"}},
      {"skin", {"Skin (Dry)", "SkinDry"}},
      {"mucous membrane", {"Skin (Wet)", "SkinWet", "MucousMembrane"}},
      {"small intestine", {"Small Intestine", "SmallIntestine"}},
      {"spleen", {"Spleen"}},
      {"stomach", {"Stomach"}},
      {"tendon", {"Tendon"}},
      {"testis", {"Testis"}},
      {"thyroid", {"Thyroid"}},
      {"tongue", {"Tongue"}},
      {"trachea", {"Trachea"}},
      {"uterus", {"Uterus"}},
      {"vitreous humour", {"Vitreous Humor", "VitreousHumor", "BodyFluid"}},
      {"gas", {"Air"}},
      {"duodenum", {"Duodenum"}},
      {"gland", {"Gland"}},
      {"lymph node", {"Lymph"}},
      {"nail", {"Nail", "toenail"}},
      {"oesophagus", {"Oesophagus", "esophagus"}},
      {"pancreas", {"Pancreas"}},
      {"prostate", {"Prostate"}},
      {"retina", {"Retina"}},
      {"spinal cord", {"SpinalCord"}},
      {"thymus", {"Thymus"}},
      {"teeth", {"Tooth"}}};
}

inline std::vector<std::string> names_of(const std::vector<NamesOfRow>& rows) {
  std::vector<std::string> names;
  for (const auto& [row, of_row] : rows) names.insert(names.end(), of_row.begin(), of_row.end());
  return names;
}

}  // namespace limber::test
