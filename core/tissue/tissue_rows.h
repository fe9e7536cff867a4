// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of all known tissues with their names, densities, dielectric properties and elements
// (assets/tissues/tissues.csv). A row is a tissue or the contents of an organ; its names are those of TotalSegmentator,
// ICRP Publication 110, the SPL atlases, BodyParts3D and the Visible Human's voxel models. The columns of the file:
//   name, names, kinds   as in tissue_match.h
//   density              kg/m3
//   dielectric, medium   names of its rows in dielectric.csv and composition.csv (both empty: a mixture, or not tissue)
//   mixture              "0.5 A + 0.5 B": rows of this table with their shares by volume. "A + B": the shares are
//                        computed so that the mixture has the row's density
//   stand_in             tells the user why another tissue's properties are used (empty: the tissue has its own)
//   source               source of the density
#pragma once

#include <string>
#include <vector>

#include "core/tissue/tissue_match.h"

namespace limber {

struct TissueShare {
  int row = 0;
  double volume = 0;  // share of the part by volume, (0, 1]
};

struct TissueRow {
  TissueNames names;
  double density = 0;                // density of the tissue, g/cm3
  std::string dielectric, medium;    // names of rows of dielectric.csv and composition.csv
  std::vector<TissueShare> mixture;  // parts with their shares, which sum to 1; empty: not a mixture
  std::string stand_in, source;
};

struct TissueRows {
  std::vector<TissueRow> rows;

  TissueMatch match(const Tissue& tissue) const;
  // Returns the parts of a row's mixture. If the row is not a mixture, returns the row itself with share 1.
  std::vector<TissueShare> parts(int row) const;
  // Returns the text of a row's parts with their shares by volume, as in "31 % bone cortical + 69 % bone cancellous".
  //   name  the member that names a part: &TissueRow::dielectric or &TissueRow::medium
  std::string parts_text(int row, std::string TissueRow::*name) const;
};

// Returns the table in the program's file tissues.csv, which is read once. If the file is not valid, throws Error,
// which names the file and the line.
const TissueRows& tissue_rows();

// The initial density of a tissue, g/cm3, with its source in words for the user. It is that of the row of tissues.csv
// that matches the tissue's name, or else its kind.
struct UsualDensity {
  double value = 0;
  std::string row, source;  // name of the row that matches the tissue (empty: none); source of the density
};
UsualDensity usual_density(const Tissue& tissue);

// Parses the text of a table with the columns of tissues.csv. If the text is not valid, throws Error, which names
// `where` (the file) and the line.
TissueRows parse_tissue_rows(std::string_view text, const std::string& where);

}  // namespace limber
