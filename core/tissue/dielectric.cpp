// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/tissue/dielectric.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "core/base/asset.h"
#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/tissue/tissue_rows.h"

namespace limber {

namespace {
constexpr double kVacuumPermittivity = 8.8541878128e-12;  // permittivity of vacuum, F/m [CODATA 2018]
constexpr std::uint64_t kMostBytes = 16 << 20;
constexpr std::string_view kColumns =
    "name,names,kinds,epsilon_infinity,delta1,tau1_ps,alpha1,delta2,tau2_ns,alpha2,delta3,tau3_us,alpha3,delta4,tau4_"
    "ms,alpha4,conductivity,source";
// Number of numeric fields of a row; they follow the columns name, names and kinds.
constexpr std::size_t kNumbers = 14;
constexpr double kSecondsOfTau[4] = {1e-12, 1e-9, 1e-6, 1e-3};

ColeCole parameters_of(const std::vector<std::string>& fields, const std::string& where) {
  std::array<double, kNumbers> value;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const auto number = number_of<double>(fields[i + 3]);
    if (!number || !(*number >= 0 && *number <= 1e12))
      throw Error("the value is " + in_quotes(fields[i + 3]), where, "write a number that is not negative");
    value[i] = *number;
  }
  ColeCole tissue{.epsilon_infinity = value[0], .dispersions = {}, .conductivity = value[13]};
  for (std::size_t n = 0; n < 4; ++n) {
    tissue.dispersions[n] = {value[1 + 3 * n], value[2 + 3 * n] * kSecondsOfTau[n], value[3 + 3 * n]};
    if (tissue.dispersions[n].alpha >= 1)
      throw Error("alpha" + std::to_string(n + 1) + " is " + text_of(value[3 + 3 * n]), where, "it must be below 1");
  }
  if (tissue.epsilon_infinity < 1)
    throw Error("epsilon_infinity is " + text_of(value[0]), where, "it must be at least 1");
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
      if (line != kColumns)
        throw Error("the columns are not those of a table of dielectric properties", where,
                    "write " + std::string(kColumns));
      has_columns = true;
      continue;
    }
    const auto fields = csv_fields(line);
    if (fields.size() != kNumbers + 4)
      throw Error("the row has " + std::to_string(fields.size()) + " fields", where,
                  "write this number of fields: " + std::to_string(kNumbers + 4));
    table.names.push_back(tissue_names_of(fields, where));
    table.parameters.push_back(parameters_of(fields, where));
    table.sources.push_back(fields.back());
  }
  if (!has_columns)
    throw Error("the table is empty", path.string(), "write a line of columns, then one row per tissue");
}
}  // namespace

Dielectric dielectric_at(const ColeCole& tissue, double frequency) {
  if (!(frequency >= kLowestFrequency && frequency <= kHighestFrequency))
    throw Error("the frequency " + text_of(frequency) + " Hz is outside the range of the tissue model", "--frequency",
                "use 10 Hz to 100 GHz (1e11)");
  const double w = 2 * std::numbers::pi * frequency;
  std::complex<double> epsilon = tissue.epsilon_infinity;
  for (const auto& [delta, tau, alpha] : tissue.dispersions)
    epsilon += delta / (1.0 + std::pow(std::complex<double>(0, w * tau), 1 - alpha));
  return {epsilon.real(), tissue.conductivity - epsilon.imag() * w * kVacuumPermittivity};
}

TissueMatch DielectricTable::match_user(const Tissue& tissue) const {
  const std::span<const TissueNames> rows = names;
  return match_tissue(tissue, rows.first(user_rows));
}

int DielectricTable::row_named(const std::string& name) const {
  for (std::size_t i = user_rows; i < names.size(); ++i)
    if (names[i].name == name) return static_cast<int>(i);
  throw Error("the table of dielectric properties has no row " + in_quotes(name), "tissues/dielectric.csv",
              "install Limber again");
}

Dielectric DielectricTable::of_tissue_row(int row, double frequency) const {
  const TissueRows& tissues = tissue_rows();
  Dielectric mean{0, 0};
  for (const TissueShare& part : tissues.parts(row)) {
    const Dielectric here = dielectric_at(parameters[row_named(tissues.rows[part.row].dielectric)], frequency);
    mean.permittivity += part.volume * here.permittivity;
    mean.conductivity += part.volume * here.conductivity;
  }
  return mean;
}

DielectricTable read_dielectric_table(const Path& user) {
  DielectricTable table;
  if (!user.empty()) append(table, user);
  table.user_rows = table.names.size();
  append(table, asset("tissues/dielectric.csv"));
  return table;
}

namespace {
std::string found_text(const TissueMatch& match, const Tissue& tissue) {
  return match.by_name ? "name: " + match.words : "kind: " + std::string(to_string(tissue.kind));
}

// Returns the sources of the dielectric properties of a tissue; for a mixture, the sources of its parts, each source
// once. `row` is the tissue's row in tissues.csv.
std::string sources_of(const DielectricTable& table, int row) {
  const TissueRows& tissues = tissue_rows();
  std::string text;
  for (const TissueShare& part : tissues.parts(row)) {
    const std::string& source = table.sources[table.row_named(tissues.rows[part.row].dielectric)];
    if (text.find(source) == text.npos) text += (text.empty() ? "" : "; ") + source;
  }
  return text;
}
}  // namespace

TissueMaterials tissue_materials(const TissueTable& tissues, const DielectricTable& table, double frequency) {
  const TissueRows& rows = tissue_rows();
  TissueMaterials found;
  for (const Tissue& tissue : tissues.tissues) {
    const TissueMatch match = rows.match(tissue), user = table.match_user(tissue);
    TissueMaterial material{.label = tissue.label, .file_value = tissue.file_value, .name = tissue.name};
    material.density = 1000 * tissue.density;
    if (material.name.empty()) material.name = "label " + text_of(tissue.file_value);
    const UsualDensity usual = usual_density(tissue);
    material.density_source = usual.value == tissue.density ? usual.source : "the body's table of tissues";
    if (user.row >= 0) {
      material.dielectric = dielectric_at(table.parameters[user.row], frequency);
      material.row = material.properties = table.names[user.row].name;
      material.source = table.sources[user.row];
      material.found = "own row, " + found_text(user, tissue);
      material.by_name = user.by_name;
    } else if (match.row >= 0 && !rows.parts_text(match.row, &TissueRow::dielectric).empty()) {
      material.dielectric = table.of_tissue_row(match.row, frequency);
      material.row = rows.rows[match.row].names.name;
      material.properties = rows.parts_text(match.row, &TissueRow::dielectric);
      material.stand_in = rows.rows[match.row].stand_in;
      material.source = sources_of(table, match.row);
      material.found = found_text(match, tissue);
      material.by_name = match.by_name;
    } else {
      found.unmatched.push_back(material.name);
      continue;
    }
    found.materials.push_back(std::move(material));
  }
  return found;
}

std::string stand_ins_text(const std::vector<TissueMaterial>& materials) {
  std::string text;
  std::set<std::string> named;
  for (const TissueMaterial& m : materials)
    if (!m.stand_in.empty() && named.insert(m.row).second)
      text += (text.empty() ? "" : "; ") + m.row + " as " + m.properties;
  if (text.empty()) return text;
  return "tissues without published properties use those of other tissues: " + text +
         " (`limber tissues` says why, and lists every match)";
}

}  // namespace limber
