// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/builtin_tissues.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "core/base/text_parse.h"

namespace limber {

namespace {
struct Row {
  int value;
  const char* name;
  TissueKind kind;
};

TissueTable make_table(const char* source, std::initializer_list<Row> rows) {
  TissueTable table;
  table.source = source;
  for (const Row& row : rows) {
    Tissue tissue;
    tissue.label = static_cast<Label>(row.value);
    tissue.file_value = row.value;
    tissue.name = row.name;
    tissue.kind = row.kind;
    apply_kind_defaults(tissue);
    table.tissues.push_back(tissue);
  }
  std::sort(table.tissues.begin(), table.tissues.end(),
            [](const Tissue& a, const Tissue& b) { return a.label < b.label; });
  return table;
}

// Returns the table of Bender's arm. No table came with that volume, so the labels' names were chosen from the
// positions and shapes of the tissues. Labels 3 and 6 are only a few scattered voxels.
const TissueTable& bender_arm() {
  static const TissueTable table =
      make_table("built-in table of Bender's arm", {{17, "muscle", TissueKind::Muscle},
                                                    {5, "fat", TissueKind::Fat},
                                                    {143, "skin", TissueKind::Skin},
                                                    {111, "cortical bone", TissueKind::CorticalBone},
                                                    {209, "marrow", TissueKind::Marrow},
                                                    {253, "cancellous bone", TissueKind::CancellousBone},
                                                    {142, "tendon", TissueKind::Tendon},
                                                    {11, "nerve", TissueKind::Nerve},
                                                    {65, "blood", TissueKind::Blood},
                                                    {189, "vessel wall", TissueKind::Vessel},
                                                    {133, "cartilage", TissueKind::Cartilage},
                                                    {8, "nail", TissueKind::Nail},
                                                    {3, "connective specks", TissueKind::Connective},
                                                    {6, "connective specks 2", TissueKind::Connective}});
  return table;
}
// The class names of TotalSegmentator's `total` task, version 2 [Wasserthal et al. 2023], in the order of their labels.
// The first class has label 1.
constexpr std::string_view kTotalSegmentator =
    "spleen kidney_right kidney_left gallbladder liver stomach pancreas adrenal_gland_right adrenal_gland_left "
    "lung_upper_lobe_left "
    "lung_lower_lobe_left lung_upper_lobe_right lung_middle_lobe_right lung_lower_lobe_right esophagus trachea "
    "thyroid_gland small_bowel "
    "duodenum colon urinary_bladder prostate kidney_cyst_left kidney_cyst_right sacrum vertebrae_S1 vertebrae_L5 "
    "vertebrae_L4 vertebrae_L3 "
    "vertebrae_L2 vertebrae_L1 vertebrae_T12 vertebrae_T11 vertebrae_T10 vertebrae_T9 vertebrae_T8 vertebrae_T7 "
    "vertebrae_T6 vertebrae_T5 "
    "vertebrae_T4 vertebrae_T3 vertebrae_T2 vertebrae_T1 vertebrae_C7 vertebrae_C6 vertebrae_C5 vertebrae_C4 "
    "vertebrae_C3 vertebrae_C2 "
    "vertebrae_C1 heart aorta pulmonary_vein brachiocephalic_trunk subclavian_artery_right subclavian_artery_left "
    "common_carotid_artery_right "
    "common_carotid_artery_left brachiocephalic_vein_left brachiocephalic_vein_right atrial_appendage_left "
    "superior_vena_cava "
    "inferior_vena_cava portal_vein_and_splenic_vein iliac_artery_left iliac_artery_right iliac_vena_left "
    "iliac_vena_right humerus_left "
    "humerus_right scapula_left scapula_right clavicula_left clavicula_right femur_left femur_right hip_left hip_right "
    "spinal_cord "
    "gluteus_maximus_left gluteus_maximus_right gluteus_medius_left gluteus_medius_right gluteus_minimus_left "
    "gluteus_minimus_right "
    "autochthon_left autochthon_right iliopsoas_left iliopsoas_right brain skull rib_left_1 rib_left_2 rib_left_3 "
    "rib_left_4 rib_left_5 "
    "rib_left_6 rib_left_7 rib_left_8 rib_left_9 rib_left_10 rib_left_11 rib_left_12 rib_right_1 rib_right_2 "
    "rib_right_3 rib_right_4 "
    "rib_right_5 rib_right_6 rib_right_7 rib_right_8 rib_right_9 rib_right_10 rib_right_11 rib_right_12 sternum "
    "costal_cartilages";

const TissueTable& total_segmentator() {
  static const TissueTable table = [] {
    TissueTable made;
    made.source = "built-in table of TotalSegmentator 2";
    for (std::string_view name : words_of(kTotalSegmentator)) {
      Tissue tissue;
      tissue.label = static_cast<Label>(made.tissues.size() + 1);
      tissue.file_value = tissue.label;
      tissue.name = name;
      tissue.kind = tissue_kind_from_name(name);
      apply_kind_defaults(tissue);
      made.tissues.push_back(tissue);
    }
    return made;
  }();
  return table;
}

// A built-in table, and the labels (marks) by which a volume that this table describes is recognized. Every such volume
// contains all of the marks, and few other volumes do. Without marks, volumes with small label numbers would match many
// tables.
struct BuiltIn {
  const TissueTable& table;
  std::vector<double> marks;
};
}  // namespace

const TissueTable* built_in_table_for(const TissueTable& present) {
  // The marks of Bender's arm are muscle, cortical bone and skin. The marks of TotalSegmentator are the spinal cord and
  // both autochthonous back muscles.
  static const std::vector<BuiltIn> kTables = {{bender_arm(), {17, 111, 143}}, {total_segmentator(), {79, 86, 87}}};
  const auto is_present = [&](double value) { return present.find_file_value(value) != nullptr; };
  for (const BuiltIn& candidate : kTables) {
    const bool covers = std::all_of(present.tissues.begin(), present.tissues.end(), [&](const Tissue& t) {
      return candidate.table.find_file_value(t.file_value) != nullptr;
    });
    if (covers && std::all_of(candidate.marks.begin(), candidate.marks.end(), is_present)) return &candidate.table;
  }
  return nullptr;
}

}  // namespace limber
