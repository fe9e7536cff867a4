// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the dielectric properties of tissues at any frequency from 10 Hz to 100 GHz by the model of four Cole-Cole
// dispersions [Gabriel, Lau & Gabriel 1996, Phys. Med. Biol. 41, 2271]. The complex permittivity at the angular
// frequency w is
//   eps(w) = eps_infinity + sum_1..4 delta_n / (1 + (i w tau_n)^(1 - alpha_n)) + sigma_ionic / (i w eps_0)
// The relative permittivity is its real part; the conductivity is -w eps_0 times its imaginary part. The parameters are
// read from assets/tissues/dielectric.csv, which contains all 44 published tissues, and gas, each with its source.
// tissues.csv (tissue_rows.h) tells which row belongs to which tissue. A table of the user, with its own names, takes
// precedence. A row without dispersions describes a tissue with equal permittivity and conductivity at all frequencies.
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
  double conductivity = 0;  // conductivity of ions, S/m
};

struct Dielectric {
  double permittivity = 1;  // permittivity relative to that of vacuum
  double conductivity = 0;  // conductivity at the frequency, S/m
};

constexpr double kLowestFrequency = 10, kHighestFrequency = 1e11;  // frequency range of the model, Hz

// Returns a tissue's dielectric properties at a frequency in Hz. Throws Error when the frequency is outside of the
// model's range.
Dielectric dielectric_at(const ColeCole& tissue, double frequency);

struct DielectricTable {
  std::vector<TissueNames> names;    // names of the tissue in each row
  std::vector<ColeCole> parameters;  // parameters of the tissue in each row
  std::vector<std::string> sources;  // source of the parameters in each row
  std::size_t user_rows = 0;         // number of rows from the user's table; they come first and take precedence

  TissueMatch match_user(const Tissue& tissue) const;  // finds the row of the user's table that fits the tissue
  // Returns the dielectric properties of a tissue at a frequency in Hz; `row` is its row in tissue_rows(). For a
  // mixture, returns the means of the properties of its parts, weighted by volume. Throws Error when a part has no row
  // in this table.
  Dielectric of_tissue_row(int row, double frequency) const;
  // Returns the row with this name in the program's table, never a row of the user's. Throws Error when no row has the
  // name.
  int row_named(const std::string& name) const;
};

// Reads the program's dielectric table. If `user` is a path, the rows of that file come first. If a row is not valid,
// throws Error, which names the file and the line.
DielectricTable read_dielectric_table(const Path& user = {});

// The properties of one tissue that a simulation of electromagnetic fields needs.
struct TissueMaterial {
  Label label = 0;
  double file_value = 0;
  std::string name;
  double density = 0;  // density of the tissue, kg/m3
  std::string density_source;
  Dielectric dielectric;
  std::string row;         // name of the row of tissues.csv or of the user's table that the tissue matches
  std::string found;       // how the row was found: "name: gall bladder", "kind: bone"
  std::string properties;  // origin of the properties: "liver", "31 % bone cortical + 69 % bone cancellous"
  std::string stand_in;    // why the properties of another tissue are used; empty: they are the tissue's own
  std::string source;      // source of the dielectric properties, in words
  bool by_name = true;     // false: the row was found by the tissue's kind, not by its name
};

struct TissueMaterials {
  std::vector<TissueMaterial> materials;  // one for each tissue with a row, in the order of labels
  std::vector<std::string> unmatched;     // names of the tissues for which no row was found
};

// Returns one line of text with the names of the tissues for which properties of another tissue are used, each name
// once. Empty when there are none.
std::string stand_ins_text(const std::vector<TissueMaterial>& materials);

// Returns the materials of a volume's tissues at a frequency in Hz.
TissueMaterials tissue_materials(const TissueTable& tissues, const DielectricTable& table, double frequency);

}  // namespace limber
