// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/composition.h"

#include <cmath>

#include "core/base/asset.h"
#include "core/base/error.h"
#include "core/volume/header_text.h"

namespace limber {

CompositionTable read_composition_table() {
  const Path path = asset("tissues/composition.csv");
  const std::string text = read_file(path);
  CompositionTable table;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const auto line = trimmed(take_line(rest));
    const std::string where = path.string() + " line " + std::to_string(++number);
    if (number == 1 || line.empty()) continue;  // the columns
    const auto fields = csv_fields(line);
    if (fields.size() != kElements.size() + 4) throw Error("the row has " + std::to_string(fields.size()) + " fields", where, "install Limber again");
    Composition shares;
    double sum = 0;
    for (std::size_t i = 0; i < kElements.size(); ++i) {
      const auto percent = number_of<double>(fields[i + 3]);
      if (!percent || !(*percent >= 0)) throw Error("the share is " + in_quotes(fields[i + 3]), where, "install Limber again");
      sum += shares[i] = *percent;
    }
    if (std::abs(sum - 100) > 0.5) throw Error("the shares add up to " + text_of(sum) + " %", where, "install Limber again");
    for (double& share : shares) share /= sum;  // published shares are rounded
    table.names.push_back(tissue_names_of(fields, where));
    table.shares.push_back(shares);
    table.sources.push_back(fields.back());
  }
  return table;
}

std::vector<int> media_of(const TissueTable& tissues, const CompositionTable& media, const std::string& where) {
  std::vector<int> rows;
  std::string without;
  for (const Tissue& tissue : tissues.tissues) {
    rows.push_back(match_tissue(tissue, media.names).row);
    if (rows.back() < 0) without += (without.empty() ? "" : ", ") + (tissue.name.empty() ? "label " + text_of(tissue.file_value) : tissue.name);
  }
  if (!without.empty()) throw Error("no elements are known of: " + without, where, "name them, or give them a kind, with --tissues");
  return rows;
}

}  // namespace limber
