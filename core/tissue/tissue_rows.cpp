// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/tissue_rows.h"

#include <cmath>

#include "core/base/asset.h"
#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
constexpr std::string_view kColumns = "name,names,kinds,density,dielectric,medium,mixture,stand_in,source";
constexpr std::size_t kFields = 9;

[[noreturn]] void refuse(const std::string& what, const std::string& where) {
  throw Error(what, where, "install Limber again");
}

TissueRow row_of(const std::vector<std::string>& fields, const std::string& where) {
  if (fields.size() != kFields) refuse("the row has " + std::to_string(fields.size()) + " fields", where);
  const auto density = number_of<double>(fields[3]);
  if (!density || !(*density > 0 && *density < 1e5)) refuse("the density is " + in_quotes(fields[3]), where);
  if (fields[8].empty()) refuse("the density has no source", where);
  return {tissue_names_of(fields, where), *density / 1000, fields[4], fields[5], {}, fields[7], fields[8]};
}

int row_named(const TissueRows& table, std::string_view name, const std::string& where) {
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.rows[i].names.name == name) return static_cast<int>(i);
  refuse("no row has the name " + in_quotes(std::string(name)), where);
}

// Removes from `text` (a mixture such as "0.5 grey matter + 0.5 white matter") the part before the first '+', and
// returns this part's row and share. A part without a number gets the share 0.
TissueShare take_share(const TissueRows& table, std::string_view& text, const std::string& where) {
  const std::size_t end = std::min(text.find('+'), text.size());
  std::string_view part = trimmed(text.substr(0, end));
  text.remove_prefix(std::min(end + 1, text.size()));
  double share = 0;
  const std::size_t blank = part.find(' ');
  const auto number = number_of<double>(part.substr(0, std::min(blank, part.size())));
  if (number && blank != part.npos) {
    share = *number;
    part = trimmed(part.substr(blank));
  }
  return {row_named(table, part, where), share};
}

// If a mixture has two parts without shares, computes their shares by volume, so that the mixture has the density of
// `row`.
void share_by_density(const TissueRows& table, const TissueRow& row, std::vector<TissueShare>& mixture,
                      const std::string& where) {
  if (mixture.size() != 2 || mixture[0].volume + mixture[1].volume != 0) return;
  const double first = table.rows[mixture[0].row].density, second = table.rows[mixture[1].row].density;
  mixture[0].volume = (row.density - second) / (first - second);
  mixture[1].volume = 1 - mixture[0].volume;
  if (!(mixture[0].volume > 0 && mixture[0].volume < 1))
    refuse("the density does not lie between those of its parts", where);
}

std::vector<TissueShare> mixture_of(const TissueRows& table, const TissueRow& row, std::string_view text,
                                    const std::string& where) {
  std::vector<TissueShare> mixture;
  while (!trimmed(text).empty()) mixture.push_back(take_share(table, text, where));
  share_by_density(table, row, mixture, where);
  double sum = 0;
  for (const TissueShare& part : mixture) {
    if (!(part.volume > 0)) refuse("a part of the mixture has no share", where);
    if (table.rows[part.row].dielectric.empty()) refuse("a part of the mixture has no dielectric properties", where);
    sum += part.volume;
  }
  if (!mixture.empty() && std::abs(sum - 1) > 1e-9)
    refuse("the shares of the mixture add up to " + text_of(sum), where);
  return mixture;
}
}  // namespace

TissueRows parse_tissue_rows(std::string_view text, const std::string& where) {
  TissueRows table;
  // For each row: text of its mixture, and the row's file and line.
  std::vector<std::pair<std::string, std::string>> mixtures;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const auto line = trimmed(take_line(rest));
    const std::string here = where + " line " + std::to_string(++number);
    if (number == 1) {
      if (line != kColumns) refuse("the columns are not " + std::string(kColumns), here);
      continue;
    }
    if (line.empty()) continue;
    const auto fields = csv_fields(line);
    table.rows.push_back(row_of(fields, here));
    mixtures.emplace_back(fields[6], here);
  }
  for (std::size_t i = 0; i < mixtures.size(); ++i)
    table.rows[i].mixture = mixture_of(table, table.rows[i], mixtures[i].first, mixtures[i].second);
  return table;
}

const TissueRows& tissue_rows() {
  static const TissueRows table = [] {
    const Path path = asset("tissues/tissues.csv");
    return parse_tissue_rows(read_file(path), path.string());
  }();
  return table;
}

UsualDensity usual_density(const Tissue& tissue) {
  constexpr double kUnknownDensity = 1.05;
  const int row = tissue_rows().match(tissue).row;
  if (row < 0) return {kUnknownDensity, "", "chosen by Limber: as most organs of ICRP Publication 110 (2009)"};
  const TissueRow& found = tissue_rows().rows[row];
  return {found.density, found.names.name, found.source};
}

TissueMatch TissueRows::match(const Tissue& tissue) const {
  return match_tissue(tissue, rows.size(), [this](std::size_t row) -> const TissueNames& { return rows[row].names; });
}

std::vector<TissueShare> TissueRows::parts(int row) const {
  if (!rows[row].mixture.empty()) return rows[row].mixture;
  return {{row, 1}};
}

std::string TissueRows::parts_text(int row, std::string TissueRow::*name) const {
  if (rows[row].mixture.empty()) return rows[row].*name;
  std::string text;
  for (const TissueShare& part : rows[row].mixture)
    text += (text.empty() ? "" : " + ") + text_of(std::round(100 * part.volume)) + " % " + rows[part.row].*name;
  return text;
}

}  // namespace limber
