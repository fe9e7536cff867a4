// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of label tables: a table is read into tissues with finite materials, or refused with Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/base/error.h"
#include "core/volume_io/tissue_table_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const limber::TissueTable table =
        limber::parse_tissue_table(std::string(reinterpret_cast<const char*>(data), size), "f");
    for (const limber::Tissue& tissue : table.tissues)
      if (!std::isfinite(tissue.file_value) || !(tissue.density > 0) || !(tissue.poisson_ratio < 0.5)) std::abort();
  } catch (const limber::Error&) {
  }
  return 0;
}
