// SPDX-License-Identifier: AGPL-3.0-or-later
// What is known of each tissue, and by which names: one table for densities, dielectric properties and elements
// (assets/tissues/tissues.csv). A row is a tissue or what an organ holds; its names are those of TotalSegmentator,
// ICRP Publication 110, the SPL atlases, BodyParts3D and the Visible Human's voxel models. Its columns:
//   name, names, kinds   as in tissue_match.h
//   density              kg/m3
//   dielectric, medium   the rows of dielectric.csv and composition.csv that hold for it
//                        (both empty: a mixture, or not tissue)
//   mixture              "0.5 A + 0.5 B": other rows with their shares of the volume
//                        ("A + B": with the shares that give the density)
//   stand_in             what is taken in place of properties of its own, for the user (empty: they are its own)
//   source               of the density
#pragma once

#include <string>
#include <vector>

#include "core/tissue/tissue_match.h"

namespace limber {

struct TissueShare {
  int row = 0;
  double volume = 0;  // (0, 1]
};

struct TissueRow {
  TissueNames names;
  double density = 0;                // g/cm3
  std::string dielectric, medium;    // names of rows
  std::vector<TissueShare> mixture;  // shares sum to 1; empty: none
  std::string stand_in, source;
};

struct TissueRows {
  std::vector<TissueRow> rows;

  TissueMatch match(const Tissue& tissue) const;
  // The parts of a row: those of its mixture, else itself whole.
  std::vector<TissueShare> parts(int row) const;
  // "31 % bone cortical + 69 % bone cancellous": the names that a row's parts have in another table, shares by volume.
  std::string parts_text(int row, std::string TissueRow::*name) const;
};

// The program's table; read once. Throws Error naming file and line.
const TissueRows& tissue_rows();

// g/cm3 that a tissue starts with, by its name, else by its kind, and where that comes from, for a user to read.
struct UsualDensity {
  double value = 0;
  std::string row, source;  // row: the tissue that it was taken for; empty: none fits
};
UsualDensity usual_density(const Tissue& tissue);

//   text, where  of a file in the form above
//   throws Error naming `where` and the line
TissueRows parse_tissue_rows(std::string_view text, const std::string& where);

}  // namespace limber
