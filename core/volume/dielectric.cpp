// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/dielectric.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "core/base/asset.h"
#include "core/base/error.h"
#include "core/volume/header_text.h"

namespace limber {

namespace {
constexpr double kVacuumPermittivity = 8.8541878128e-12;  // F/m [CODATA 2018]
constexpr std::uint64_t kMostBytes = 16 << 20;
constexpr std::string_view kColumns =
    "name,names,kinds,epsilon_infinity,delta1,tau1_ps,alpha1,delta2,tau2_ns,alpha2,delta3,tau3_us,alpha3,delta4,tau4_ms,alpha4,conductivity,source";
constexpr std::size_t kNumbers = 14;  // behind name, names and kinds
constexpr double kSecondsOfTau[4] = {1e-12, 1e-9, 1e-6, 1e-3};

ColeCole parameters_of(const std::vector<std::string>& fields, const std::string& where) {
  std::array<double, kNumbers> value;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const auto number = number_of<double>(fields[i + 3]);
    if (!number || !(*number >= 0 && *number <= 1e12)) throw Error("the value is " + in_quotes(fields[i + 3]), where, "write a number that is not negative");
    value[i] = *number;
  }
  ColeCole tissue{.epsilon_infinity = value[0], .dispersions = {}, .conductivity = value[13]};
  for (std::size_t n = 0; n < 4; ++n) {
    tissue.dispersions[n] = {value[1 + 3 * n], value[2 + 3 * n] * kSecondsOfTau[n], value[3 + 3 * n]};
    if (tissue.dispersions[n].alpha >= 1) throw Error("alpha" + std::to_string(n + 1) + " is " + text_of(value[3 + 3 * n]), where, "it must be below 1");
  }
  if (tissue.epsilon_infinity < 1) throw Error("epsilon_infinity is " + text_of(value[0]), where, "it must be at least 1");
  return tissue;
}

void append(DielectricTable& table, const Path& path) {
  const std::string text = read_file(path, kMostBytes);
  int number = 0;
  bool has_columns = false;
  for (std::string_view rest = text; !rest.empty();) {
    const auto line = trimmed(take_line(rest));
    const std::string where = path.string() + " line " + std::to_string(++number);
    if (line.empty() || line[0] == '#') continue;
    if (!has_columns) {
      if (line != kColumns) throw Error("the columns are not those of a table of dielectric properties", where, "write " + std::string(kColumns));
      has_columns = true;
      continue;
    }
    const auto fields = csv_fields(line);
    if (fields.size() != kNumbers + 4) throw Error("the row has " + std::to_string(fields.size()) + " fields", where, "write " + std::to_string(kNumbers + 4));
    table.names.push_back(tissue_names_of(fields, where));
    table.parameters.push_back(parameters_of(fields, where));
    table.sources.push_back(fields.back());
  }
  if (!has_columns) throw Error("the table is empty", path.string(), "write a line of columns, then a row a tissue");
}
}  // namespace

Dielectric dielectric_at(const ColeCole& tissue, double frequency) {
  if (!(frequency >= kLowestFrequency && frequency <= kHighestFrequency))
    throw Error("the frequency " + text_of(frequency) + " Hz is outside of what the model of tissue holds for", "--frequency", "choose 10 Hz to 100 GHz (1e11)");
  const double w = 2 * std::numbers::pi * frequency;
  std::complex<double> epsilon = tissue.epsilon_infinity;
  for (const auto& [delta, tau, alpha] : tissue.dispersions) epsilon += delta / (1.0 + std::pow(std::complex<double>(0, w * tau), 1 - alpha));
  return {epsilon.real(), tissue.conductivity - epsilon.imag() * w * kVacuumPermittivity};
}

TissueMatch DielectricTable::match(const Tissue& tissue) const {
  const std::span<const TissueNames> rows = names;
  const TissueMatch by_user = match_tissue(tissue, rows.first(user_rows));
  if (by_user.row >= 0) return by_user;
  TissueMatch match = match_tissue(tissue, rows.subspan(user_rows));
  if (match.row >= 0) match.row += static_cast<int>(user_rows);
  return match;
}

DielectricTable read_dielectric_table(const Path& user) {
  DielectricTable table;
  if (!user.empty()) append(table, user);
  table.user_rows = table.names.size();
  append(table, asset("tissues/dielectric.csv"));
  return table;
}

TissueMaterials tissue_materials(const TissueTable& tissues, const DielectricTable& table, double frequency) {
  TissueMaterials found;
  for (const Tissue& tissue : tissues.tissues) {
    const std::string name = tissue.name.empty() ? "label " + text_of(tissue.file_value) : tissue.name;
    const TissueMatch match = table.match(tissue);
    if (match.row < 0) {
      found.unmatched.push_back(name);
      continue;
    }
    found.materials.push_back({tissue.label, tissue.file_value, name, 1000 * tissue.density, dielectric_at(table.parameters[match.row], frequency),
                               table.names[match.row].name, table.sources[match.row], match.by_name});
  }
  return found;
}

}  // namespace limber
