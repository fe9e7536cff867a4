// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a label volume for simulation programs. First the voxel axes are permuted and flipped so that they point to
// the left, back and top (L, P, S); voxels are not resampled. If the grid is oblique, the written coordinates are along
// the voxel axes. Each file is written completely or not at all. The formats:
//   .xml         openEMS with its CSXCAD structure: greedy boxes of materials with permittivity, conductivity and
//                density, a mesh line at every voxel face, millimetres. The file also sets a Gaussian pulse around the
//                frequency and absorbing walls; the user adds the source. (openEMS 0.0.35 of Debian cannot read voxels
//                from HDF5, because it truncates 64-bit handles.)
//   .csxcad.h5   CSXCAD's DiscMaterial, version 2: a material index for each voxel, metres (set Scale = 1 / unit).
//   .gprmax.h5   voxels for gprMax's command #geometry_objects_read, metres, with NAME_materials.txt, whose comments
//                state densities.
//   .dat         slices of organ numbers as in ICRP Publication 110: x (right to left) fastest, then y (front to back),
//                then z (upwards), 16 numbers per line, with NAME_organs.dat (number, name, medium, density) and
//                NAME_media.dat (elements, %).
#pragma once

#include <string>
#include <vector>

#include "core/tissue/composition.h"
#include "core/tissue/dielectric.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SimulationBody {
  LabelVolume volume;                     // with voxel axes to the left, back and top (L, P, S)
  std::vector<TissueMaterial> materials;  // material of every label in the volume
  double frequency = 0;                   // frequency of the field to simulate, Hz
};

// Returns the volume with its voxel axes permuted and flipped so that they point to the left, back and top (L, P, S).
// Adds a warning if the grid is oblique.
LabelVolume turned_to_lps(const LabelVolume& volume, std::vector<std::string>& warnings);

std::string openems_xml(const SimulationBody& body);
// Each of these functions writes a body in one format. They throw Error if a file cannot be written, or if the format
// does not allow so many materials.
void write_openems(const SimulationBody& body, const Path& path);
void write_disc_material(const SimulationBody& body, const Path& path);
void write_gprmax(const SimulationBody& body, const Path& path);
void write_icrp_slices(const LabelVolume& volume, const TissueTable& tissues, const CompositionTable& media,
                       const Path& path);

// Returns the path of an additional file beside `path`: NAME + `end`, for the `path` NAME.gprmax.h5 or NAME.dat.
Path beside(const Path& path, const std::string& end);

}  // namespace limber
