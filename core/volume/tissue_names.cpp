// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "core/volume/header_text.h"
#include "core/volume/tissue_table.h"

namespace limber {

std::optional<TissueKind> tissue_kind_from_text(std::string_view text) {
  const std::string wanted = lower_case(trimmed(text));
  for (int kind = 0; kind <= static_cast<int>(TissueKind::Nail); ++kind)
    if (to_string(static_cast<TissueKind>(kind)) == wanted) return static_cast<TissueKind>(kind);
  return std::nullopt;
}

TissueKind tissue_kind_from_name(std::string_view tissue_name) {
  return tissue_kind_from_text(tissue_name).value_or(TissueKind::Unknown);
}

}  // namespace limber
