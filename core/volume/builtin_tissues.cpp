// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/builtin_tissues.h"

#include <algorithm>
#include <initializer_list>

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
  std::sort(table.tissues.begin(), table.tissues.end(), [](const Tissue& a, const Tissue& b) { return a.label < b.label; });
  return table;
}

// Named from their places and shapes; no table of the original survives. 3 and 6 are specks.
const TissueTable& bender_arm() {
  static const TissueTable table = make_table(
      "built-in table of Bender's arm",
      {{17, "muscle", TissueKind::Muscle}, {5, "fat", TissueKind::Fat}, {143, "skin", TissueKind::Skin},
       {111, "cortical bone", TissueKind::CorticalBone}, {209, "marrow", TissueKind::Marrow},
       {253, "cancellous bone", TissueKind::CancellousBone}, {142, "tendon", TissueKind::Tendon}, {11, "nerve", TissueKind::Nerve},
       {65, "blood", TissueKind::Blood}, {189, "vessel wall", TissueKind::Vessel}, {133, "cartilage", TissueKind::Cartilage},
       {8, "nail", TissueKind::Nail}, {3, "connective specks", TissueKind::Connective}, {6, "connective specks 2", TissueKind::Connective}});
  return table;
}
}  // namespace

const TissueTable* built_in_table_for(const TissueTable& present) {
  for (const TissueTable* table : {&bender_arm()}) {
    const bool covers = std::all_of(present.tissues.begin(), present.tissues.end(),
                                    [&](const Tissue& t) { return table->find_file_value(t.file_value) != nullptr; });
    if (covers && !present.tissues.empty()) return table;
  }
  return nullptr;
}

}  // namespace limber
