// SPDX-License-Identifier: AGPL-3.0-or-later
// limber tissues [VOLUME] --frequency HZ [--tissues T] [--properties P.csv] [--json] [-o OUT.csv]: lists permittivity,
// conductivity and density of each tissue of a volume, or without a volume of every row of the property table. Each
// tissue is listed with the table row that it was matched to, and how it was matched.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/base/text_parse.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/tissue_options.h"
#include "core/tissue/tissue_rows.h"
#include "core/volume_io/grey_image.h"

namespace limber::cmd {

namespace {
struct TissuesOptions {
  std::string volume, output, progress;
  MaterialOptions material;
  bool json = false;
};

std::string matched(const TissueMaterial& material) { return material.by_name ? "name" : "kind"; }

std::string csv_of(const TissueMaterials& tissues) {
  std::string text =
      "label,tissue,row,matched,found,density_kg_m3,density_source,properties,stand_in,"
      "relative_permittivity,conductivity_S_m,source\n";
  for (const TissueMaterial& m : tissues.materials)
    text += text_of(m.file_value) + "," + csv_field(m.name) + "," + csv_field(m.row) + "," + matched(m) + "," +
            csv_field(m.found) + "," + text_of(m.density) + "," + csv_field(m.density_source) + "," +
            csv_field(m.properties) + "," + csv_field(m.stand_in) + "," + text_of(m.dielectric.permittivity) + "," +
            text_of(m.dielectric.conductivity) + "," + csv_field(m.source) + "\n";
  return text;
}

nlohmann::ordered_json json_of(const TissueMaterials& tissues, double frequency) {
  nlohmann::ordered_json json = {{"kind", "tissue properties"},
                                 {"frequency", frequency},
                                 {"tissues", nlohmann::ordered_json::array()},
                                 {"unmatched", tissues.unmatched}};
  for (const TissueMaterial& m : tissues.materials)
    json["tissues"].push_back({{"label", m.file_value},
                               {"name", m.name},
                               {"row", m.row},
                               {"matched", matched(m)},
                               {"found", m.found},
                               {"density_kg_m3", m.density},
                               {"density_source", m.density_source},
                               {"properties", m.properties},
                               {"stand_in", m.stand_in},
                               {"relative_permittivity", m.dielectric.permittivity},
                               {"conductivity_S_m", m.dielectric.conductivity},
                               {"source", m.source}});
  return json;
}

void print_table(const TissueMaterials& tissues) {
  print("%8s  %-28s %-22s %-28s %10s %12s %12s  %s\n", "label", "tissue", "matched row", "matched by", "kg/m3", "eps_r",
        "S/m", "properties from");
  for (const TissueMaterial& m : tissues.materials)
    print("%8s  %-28s %-22s %-28s %10.4g %12.5g %12.5g  %s\n", text_of(m.file_value).c_str(), one_line(m.name).c_str(),
          one_line(m.row).c_str(), one_line(m.found).c_str(), m.density, m.dielectric.permittivity,
          m.dielectric.conductivity,
          one_line(m.properties + (m.stand_in.empty() ? "" : " (stand-in: " + m.stand_in + ")")).c_str());
}

// Returns a tissue table with one tissue for each row of the user's property table and each row of the program's own
// table that has dielectric properties.
TissueTable rows_as_tissues(const DielectricTable& table) {
  std::vector<TissueNames> all(table.names.begin(), table.names.begin() + static_cast<std::ptrdiff_t>(table.user_rows));
  for (const TissueRow& row : tissue_rows().rows)
    if (!row.dielectric.empty() || !row.mixture.empty()) all.push_back(row.names);
  TissueTable rows;
  for (const TissueNames& names : all) {
    Tissue tissue;
    tissue.name = names.name;
    tissue.kind = names.kinds.empty() ? tissue_kind_from_name(names.name) : names.kinds.front();
    apply_kind_defaults(tissue);
    tissue.file_value = static_cast<double>(rows.tissues.size() + 1);
    rows.tissues.push_back(std::move(tissue));
  }
  return rows;
}

void list_tissues(const TissuesOptions& options) {
  if (!options.output.empty()) check_place(options.output);
  CommandProgress progress(options.progress);
  const DielectricTable table = read_dielectric_table(options.material.properties);
  TissueTable tissues = rows_as_tissues(table);
  if (!options.volume.empty()) {
    const VolumeFile file = read_volume(options.volume, progress);
    warn(file.warnings);
    tissues = tissues_of(file, options.material.tissues);
    require_labels(file.volume, tissues, options.volume);
  }
  const TissueMaterials found = tissue_materials(tissues, table, *options.material.frequency);
  if (!options.output.empty()) write_file_atomically(options.output, csv_of(found));
  if (options.json)
    print_json(
        json_of(found, *options.material.frequency).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
        "\n");
  else if (options.output.empty()) print_table(found);
  if (!found.unmatched.empty())
    warn("no dielectric properties are known for: " + joined(found.unmatched) + ": add rows with --properties");
}
}  // namespace

void add_tissues(CLI::App& app) {
  auto* command =
      app.add_subcommand("tissues", "lists the permittivity, conductivity and density of each tissue at a frequency");
  auto options = std::make_shared<TissuesOptions>();
  command->add_option("VOLUME", options->volume, "label volume (default: lists every row of the table)");
  add_material_options(*command, options->material)->required();
  command->add_flag("--json", options->json, "print as JSON");
  writes(command->add_option("-o,--output", options->output, "CSV file to write: the list as comma-separated values"))
      ->type_name("OUT.csv");
  command
      ->add_option("--progress", options->progress,
                   "with the value json: print progress to stderr, one line of JSON per step (default: a progress bar)")
      ->check(CLI::IsMember({"json"}));
  command->callback([options] { list_tissues(*options); });
}

}  // namespace limber::cmd
