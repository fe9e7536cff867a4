// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/builtin_tissues.h"
#include "core/tissue/tissue_table.h"

namespace limber {

TissueTable merge_tissue_tables(const TissueTable& in_file, const TissueTable* user) {
  TissueTable merged = in_file;
  bool named = false;
  static const TissueTable kNone;
  const FileValueIndex by_value(user ? *user : kNone);
  for (Tissue& tissue : merged.tissues) {
    const Tissue* from_user = by_value.find(tissue.file_value);
    if (from_user) {
      const Label label = tissue.label;
      tissue = *from_user;
      tissue.label = label;
    }
    named = named || !tissue.name.empty() || tissue.kind != TissueKind::Unknown;
  }
  if (user && !user->tissues.empty()) {
    merged.source = user->source;
  } else if (!named) {
    if (const TissueTable* built_in = built_in_table_for(merged)) {
      for (Tissue& tissue : merged.tissues) {
        const Label label = tissue.label;
        tissue = *built_in->find_file_value(tissue.file_value);
        tissue.label = label;
      }
      merged.source = built_in->source;
    }
  }
  return merged;
}

}  // namespace limber
