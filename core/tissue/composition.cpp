// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/composition.h"

#include <cmath>

#include "core/base/asset.h"
#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/tissue/tissue_rows.h"

namespace limber {

namespace {
int row_named(const CompositionTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (table.names[i].name == name) return static_cast<int>(i);
  throw Error("the table of media has no row " + in_quotes(name), "tissues/composition.csv", "install Limber again");
}

// Appends one medium to `table` for each tissue that is a mixture, unless the table has it already. The medium's name
// lists the parts of the mixture.
void append_mixtures(CompositionTable& table) {
  const TissueRows& tissues = tissue_rows();
  for (int row = 0; row < std::ssize(tissues.rows); ++row) {
    if (tissues.rows[row].mixture.empty()) continue;
    const std::string name = tissues.parts_text(row, &TissueRow::medium);
    bool is_there = false;
    for (const TissueNames& names : table.names) is_there = is_there || names.name == name;
    if (is_there) continue;
    Composition shares{};
    double mass = 0;
    std::string source;
    for (const TissueShare& part : tissues.rows[row].mixture) {
      const double part_mass = part.volume * tissues.rows[part.row].density;
      const int medium = row_named(table, tissues.rows[part.row].medium);
      mass += part_mass;
      for (std::size_t i = 0; i < shares.size(); ++i) shares[i] += part_mass * table.shares[medium][i];
      source += (source.empty() ? "" : "; ") + table.sources[medium];
    }
    for (double& share : shares) share /= mass;
    table.names.push_back({name, {}, {}, {}});
    table.shares.push_back(shares);
    table.sources.push_back(source);
  }
}
}  // namespace

CompositionTable read_composition_table() {
  const Path path = asset("tissues/composition.csv");
  const std::string text = read_file(path);
  CompositionTable table;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const auto line = trimmed(take_line(rest));
    const std::string where = path.string() + " line " + std::to_string(++number);
    if (number == 1 || line.empty()) continue;  // the first line names the columns
    const auto fields = csv_fields(line);
    if (fields.size() != kElements.size() + 4)
      throw Error("the row has " + std::to_string(fields.size()) + " fields", where, "install Limber again");
    Composition shares;
    double sum = 0;
    for (std::size_t i = 0; i < kElements.size(); ++i) {
      const auto percent = number_of<double>(fields[i + 3]);
      if (!percent || !(*percent >= 0))
        throw Error("the share is " + in_quotes(fields[i + 3]), where, "install Limber again");
      sum += shares[i] = *percent;
    }
    if (std::abs(sum - 100) > 0.5)
      throw Error("the shares add up to " + text_of(sum) + " %", where, "install Limber again");
    // The shares are scaled to the sum 1, because published shares are rounded.
    for (double& share : shares) share /= sum;
    table.names.push_back(tissue_names_of(fields, where));
    table.shares.push_back(shares);
    table.sources.push_back(fields.back());
  }
  append_mixtures(table);
  return table;
}

std::vector<int> media_of(const TissueTable& tissues, const CompositionTable& media, const std::string& where) {
  const TissueRows& known = tissue_rows();
  std::vector<int> rows;
  std::string without;
  for (const Tissue& tissue : tissues.tissues) {
    const int match = known.match(tissue).row;
    const std::string medium = match < 0 ? "" : known.parts_text(match, &TissueRow::medium);
    rows.push_back(medium.empty() ? -1 : row_named(media, medium));
    if (rows.back() < 0)
      without +=
          (without.empty() ? "" : ", ") + (tissue.name.empty() ? "label " + text_of(tissue.file_value) : tissue.name);
  }
  if (!without.empty())
    throw Error("no elements are known for: " + without, where,
                "give these tissues other names or kinds with --tissues");
  return rows;
}

}  // namespace limber
