// SPDX-License-Identifier: AGPL-3.0-or-later
// A label volume as what simulations take. Voxel axes are turned to L, P, S first (exactly, no voxel is resampled); on
// an oblique grid coordinates run along the voxel axes. Files appear whole or not at all; where a body is two files,
// the one that names the other comes last.
//   .xml         openEMS with the CSXCAD structure in it: greedy boxes of materials with permittivity, conductivity and
//   density, a
//                mesh line at every voxel face, millimetres. A Gaussian pulse about the frequency and absorbing walls
//                are set; the source is the user's to add. (openEMS 0.0.35 of Debian cannot read voxels from HDF5: it
//                cuts 64-bit handles.)
//   .csxcad.h5   CSXCAD's DiscMaterial, version 2: an index of a material for each voxel, metres (give it Scale = 1 /
//   unit) .gprmax.h5   gprMax's #geometry_objects_read, metres, with NAME_materials.txt; densities in its comments .dat
//   slices of organ numbers as ICRP Publication 110 has them: x (right to left) fastest, then y (front to back), then z
//                (upwards), 16 numbers a line, with NAME_organs.dat (number, name, medium, density) and NAME_media.dat
//                (elements, %)
#pragma once

#include <string>
#include <vector>

#include "core/tissue/composition.h"
#include "core/tissue/dielectric.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SimulationBody {
  LabelVolume volume;                     // axes L, P, S
  std::vector<TissueMaterial> materials;  // of every label in it
  double frequency = 0;                   // Hz
};

// The volume turned to L, P, S.   warnings  told where the grid is oblique
LabelVolume turned_to_lps(const LabelVolume& volume, std::vector<std::string>& warnings);

std::string openems_xml(const SimulationBody& body);
//   throws Error when a file cannot be written, or the format cannot hold so many materials
void write_openems(const SimulationBody& body, const Path& path);
void write_disc_material(const SimulationBody& body, const Path& path);
void write_gprmax(const SimulationBody& body, const Path& path);
void write_icrp_slices(const LabelVolume& volume, const TissueTable& tissues, const CompositionTable& media,
                       const Path& path);

// "NAME" with another end, where NAME.gprmax.h5 or NAME.dat is written.
Path beside(const Path& path, const std::string& end);

}  // namespace limber
