// SPDX-License-Identifier: AGPL-3.0-or-later
// Dielectric properties of tissue at any frequency from 10 Hz to 100 GHz by the model of four Cole-Cole dispersions
// [Gabriel, Lau & Gabriel 1996, Phys. Med. Biol. 41, 2271]:
//   eps(w) = eps_infinity + sum_1..4 delta_n / (1 + (i w tau_n)^(1 - alpha_n)) + sigma_ionic / (i w eps_0)
// Relative permittivity is its real part, conductivity -w eps_0 times its imaginary part. Parameters stand in a table
// of comma-separated values, each with its source: assets/tissues/dielectric.csv holds all 44 that were published, and
// gas. Which of them a tissue has stands in tissues.csv (tissue_rows.h); a table of the user's, with names of its own,
// goes before it. A tissue with one permittivity and conductivity at every frequency is a row without dispersions.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/tissue/tissue_match.h"

namespace limber {

struct ColeCole {
  struct Dispersion {
    double delta = 0, tau = 0 /* s */, alpha = 0;
  };
  double epsilon_infinity = 1;
  std::array<Dispersion, 4> dispersions;
  double conductivity = 0;  // ionic, S/m
};

struct Dielectric {
  double permittivity = 1;  // relative
  double conductivity = 0;  // S/m
};

constexpr double kLowestFrequency = 10, kHighestFrequency = 1e11;  // Hz, of the model

//   throws Error for a frequency (Hz) outside of the model's range
Dielectric dielectric_at(const ColeCole& tissue, double frequency);

struct DielectricTable {
  std::vector<TissueNames> names;    // #rows
  std::vector<ColeCole> parameters;  // #rows
  std::vector<std::string> sources;  // #rows
  std::size_t user_rows = 0;         // the first of them are the user's: they are asked before all others

  TissueMatch match_user(const Tissue& tissue) const;  // among the user's rows
  // Of one part or a mixture, whose permittivity and conductivity are the means by volume of its parts'.
  //   row  of tissue_rows(); throws Error when a part has no row here
  Dielectric of_tissue_row(int row, double frequency) const;
  int row_named(const std::string& name) const;  // of the program's; throws Error when there is none
};

// The table of the program, behind the rows of the user's where a path is given.
//   throws Error naming file and line
DielectricTable read_dielectric_table(const Path& user = {});

// What a simulation of fields needs to know of a tissue.
struct TissueMaterial {
  Label label = 0;
  double file_value = 0;
  std::string name;
  double density = 0;  // kg/m3
  std::string density_source;
  Dielectric dielectric;
  std::string row;         // the tissue that it was taken for: a row of tissues.csv, or of the user's table
  std::string found;       // how: "name: gall bladder", "kind: bone"
  std::string properties;  // whose they are: "liver", "31 % bone cortical + 69 % bone cancellous"
  std::string stand_in;    // why, where that is another tissue; else empty
  std::string source;      // of the properties
  bool by_name = true;     // else only its kind fits the row
};

struct TissueMaterials {
  std::vector<TissueMaterial> materials;  // in the order of labels
  std::vector<std::string> unmatched;     // names of tissues that no row fits
};

// One line that names the tissues (rows, each once) whose properties are taken from others; empty without any.
std::string stand_ins_text(const std::vector<TissueMaterial>& materials);

// Of the tissues of a table, those that are in a volume.
TissueMaterials tissue_materials(const TissueTable& tissues, const DielectricTable& table, double frequency);

}  // namespace limber
