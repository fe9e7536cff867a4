// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/tissue_options.h"

#include "core/base/error.h"

namespace limber::cmd {

CLI::Option* add_material_options(CLI::App& command, MaterialOptions& options) {
  command.add_option("--tissues", options.tissues, "tissue table (JSON, .ctbl, ITK-SNAP): names, kinds and densities");
  command
      .add_option("--properties", options.properties,
                  "CSV table of dielectric properties; its rows take precedence over the built-in table")
      ->type_name("P.csv");
  return command
      .add_option("--frequency", options.frequency, "frequency of the electromagnetic field, Hz, such as 900e6")
      ->type_name("HZ");
}

TissueTable tissues_of(const VolumeFile& file, const std::string& table) {
  if (table.empty()) return merge_tissue_tables(file.tissues, nullptr);
  const TissueTable user = read_tissue_table(table);
  return merge_tissue_tables(file.tissues, &user);
}

std::vector<TissueMaterial> materials_of(const TissueTable& tissues, const MaterialOptions& options,
                                         const std::string& where) {
  if (!options.frequency)
    throw Error("permittivity and conductivity depend on the frequency", where,
                "add --frequency, as in --frequency 900e6");
  TissueMaterials found = tissue_materials(tissues, read_dielectric_table(options.properties), *options.frequency);
  if (!found.unmatched.empty())
    throw Error("no dielectric properties are known for: " + joined(found.unmatched), where,
                "add rows with --properties, or merge labels with `limber prepare --merge`");
  return std::move(found.materials);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace limber::cmd
